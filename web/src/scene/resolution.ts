/** Reduces the resolution if drawing is slow, for example without a graphics card. */
import type { WebGLRenderer } from "three";

/** Drawing time from which a frame is slow (ms); corresponds to 30 frames per second. */
const SLOW = 33;
/** One frame in this many is timed. */
const SAMPLE = 8;
/** Number of consecutive slow frames that reduce the resolution; a single one may be caused by another program. */
const IN_A_ROW = 2;
const LEAST = 0.5;

export class Resolution {
  readonly #renderer: WebGLRenderer;
  readonly #gl: WebGL2RenderingContext;
  readonly #changed: () => void;
  #ratio = Math.min(devicePixelRatio, 2);
  #pictures = 0;
  #slow = 0;

  /** Calls `changed` when the scene must be redrawn. */
  constructor(renderer: WebGLRenderer, gl: WebGL2RenderingContext, changed: () => void) {
    this.#renderer = renderer;
    this.#gl = gl;
    this.#changed = changed;
    renderer.setPixelRatio(this.#ratio);
  }

  /** Must be called after each drawn frame. */
  drawn(): void {
    if (this.#ratio <= LEAST || this.#pictures++ % SAMPLE !== 1) return;
    const fence = this.#gl.fenceSync(this.#gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (!fence) return;
    this.#gl.flush();
    this.#time(fence, performance.now());
  }

  /** Waits without blocking until the frame is finished. */
  #time(fence: WebGLSync, start: number): void {
    const gl = this.#gl;
    const took = performance.now() - start;
    const done = gl.getSyncParameter(fence, gl.SYNC_STATUS) === gl.SIGNALED;
    if (!done && took < 10 * SLOW) {
      setTimeout(() => this.#time(fence, start), 4);
      return;
    }
    gl.deleteSync(fence);
    this.#slow = took > SLOW ? this.#slow + 1 : 0;
    if (this.#slow >= IN_A_ROW) this.#lower();
  }

  #lower(): void {
    this.#slow = 0;
    this.#ratio = Math.max(LEAST, 0.7 * this.#ratio);
    this.#renderer.setPixelRatio(this.#ratio);
    this.#changed();
  }
}
