/** Messages between the page and its worker. */

/** Settings of a run, as the program takes them. */
export interface RunSettings {
  /** Name of a built-in experiment. */
  experiment: string;
  /** Random seed and source of forces; the experiment's by default. */
  seed?: number;
  sensing?: "direct" | "image";
  /** Changes of the form `KEY=VALUE`, as for `feeler run --set`. */
  set: string[];
}

/** What the page can run: names of the built-in experiments and control laws. */
export interface Catalogue {
  version: string;
  experiments: string[];
  laws: string[];
}

export interface Experiment {
  name: string;
  description: string;
  seed: number;
  sensing: "direct" | "image";
  law: string;
  /** Values of the experiment file, with defaults. */
  config: object;
}

export interface FinishedRun {
  /** SHA-256 digest of the run, equal to that of `feeler run` with the same settings. */
  digest: string;
  /** Content of `summary.json`. */
  summary: string;
  /** Content of `recording.mcap`. */
  recording: Uint8Array<ArrayBuffer>;
}

/** Markers of a fingertip, located in an image or read from a layout file. */
export interface LocatedFingertip {
  markers: number;
  /** Columns and rows of the images (px). */
  width: number;
  height: number;
  /** Text of the layout file, as `feeler locate` writes it. */
  layout: string;
  warnings: string[];
}

/** Thresholds of the flags: compressions (N) and shear rate (N/s). */
export interface Thresholds {
  touch: number;
  over: number;
  slip: number;
}

/** Forces in one image, from a calibration of the elements or of the total wrench. */
export type Sensed =
  | {
      kind: "elements";
      touch: boolean;
      slip: boolean;
      over: boolean;
      /** Sum of the compressions (N). */
      grasp_force: number;
      /** Number of elements without a valid force. */
      invalid: number;
    }
  | {
      kind: "wrench";
      /** Force (N) and torque (N m); `null` for components that are not calibrated. */
      components: (number | null)[];
      /** `false` if the image is unlike those of the calibration. */
      valid: boolean;
    };

/** State of a run, as on a live page. */
export interface RunState {
  state: string;
  stopped: boolean;
  over: boolean;
  /** Simulated time (s). */
  time: number;
}

/** Functions of the worker: argument and result of each. */
export interface Calls {
  catalogue: { argument: undefined; result: Catalogue };
  /** Describes a built-in experiment. */
  experiment: { argument: { name: string }; result: Experiment };
  /** Sets up a run and returns the data of its live page (JSON). The run is paused. */
  create: { argument: { run: number; settings: RunSettings; keep: number }; result: string };
  /** Advances a run at `speed` times real time (`Infinity`: as fast as possible), or pauses it (0). */
  pace: { argument: { run: number; speed: number }; result: undefined };
  /** Computes a run as fast as possible up to `time` (s), also if it is paused. */
  skip: { argument: { run: number; time: number }; result: undefined };
  /** Advances a paused run by `steps` control steps. */
  step: { argument: { run: number; steps: number }; result: undefined };
  order: { argument: { run: number; order: "stop" | "resume" }; result: undefined };
  /** Multiplies the friction on all objects by `factor` from now on. */
  friction: { argument: { run: number; factor: number }; result: undefined };
  finish: { argument: { run: number }; result: FinishedRun };
  discard: { argument: { run: number }; result: undefined };
  /** Locates the markers of an untouched fingertip; later images are tracked from there. */
  locate: { argument: { rgba: ArrayBuffer; width: number; height: number }; result: LocatedFingertip };
  /** Loads the markers from the layout file content `text`. */
  layout: { argument: { text: string }; result: LocatedFingertip };
  /** Loads a calibration from the file content `text`; later images yield forces. Returns whether it gives flags. */
  calibrate: { argument: { text: string }; result: boolean };
  thresholds: { argument: Thresholds; result: undefined };
  /** Tracks the markers into an image of the same size, taken at `time` (s). Numbers of a marker: see `markers.ts`. */
  track: {
    argument: { rgba: ArrayBuffer; time: number };
    result: { markers: Float32Array<ArrayBuffer>; sensed: Sensed | undefined };
  };
  /** Returns the report page (HTML) of a recording. */
  report: { argument: { file: File }; result: string };
}

export type Request = {
  [Name in keyof Calls]: { call: number; name: Name; argument: Calls[Name]["argument"] };
}[keyof Calls];

export type Reply =
  | { kind: "ready" }
  | { kind: "done"; call: number; result: unknown }
  | { kind: "failed"; call: number; error: string }
  /** Progress of a call, 0 to 1. */
  | { kind: "progress"; call: number; share: number }
  /** New rows of a run, each in the form of a live page's message, and its state. */
  | { kind: "rows"; run: number; rows: ArrayBuffer; state: RunState }
  /** A run ended with an error. */
  | { kind: "broken"; run: number; error: string };
