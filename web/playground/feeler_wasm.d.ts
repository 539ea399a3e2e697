/** The program's interface, from `crates/feeler-wasm`. */
declare module "*/wasm/feeler_wasm" {
  export function initSync(options: { module: WebAssembly.Module }): void;
  export function catalogue(): string;
  export function experiment(name: string): string;
  export function report(file: File, progress: (share: number) => void): string;
  export class Run {
    constructor(experiment: string, settings: string[]);
    page(keep: number): string;
    step(steps: number): Uint8Array;
    state(): string;
    stop(): void;
    resume(): void;
    set_friction(factor: number): void;
    finish(wallTime: number): FinishedRun;
    free(): void;
  }
  export class Fingertip {
    constructor(rgba: Uint8Array, width: number, height: number);
    static from_layout(text: string): Fingertip;
    calibrate(text: string): boolean;
    set_thresholds(touchForce: number, overForce: number, slipThreshold: number): void;
    track(rgba: Uint8Array, stamp: number): Float32Array<ArrayBuffer>;
    sensed(): string;
    markers(): number;
    width(): number;
    height(): number;
    layout(): string;
    warnings(): string[];
    free(): void;
  }
  export class FinishedRun {
    readonly digest: string;
    readonly summary: string;
    readonly recording: Uint8Array<ArrayBuffer>;
    free(): void;
  }
}
