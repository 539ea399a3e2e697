/**
 * Data of a page: the contract between `feeler-report`, which writes it into the document, and this script, which
 * displays it. `crates/feeler-report/src/page_data` defines the same structs. `test/examples.ts` contains data of pages
 * from `feeler-report`: a Rust test keeps it up to date, and the compiler checks it against these types.
 *
 * The document contains one `<script type="application/json" id="page-data">` with a {@link PageData}. All values are
 * in SI units; the axes of a figure define how they are scaled for display.
 */
export interface PageData {
  /** Version of this contract. Other versions are rejected with a message. */
  version: 1;
  /** Page title, for example "cap-closing, seed 0". */
  title: string;
  /** Recorded values, if the page shows a single run. */
  run?: RunTable;
  /** 3-D scene, if the page shows a single run. */
  scene?: Scene;
  figures: Figure[];
  /** Source of rows while the rig runs; missing in a report. */
  live?: Live;
}

/** Rows of a run, stored by column. There is at most one row per control step. */
export interface RunTable {
  rows: number;
  columns: Column[];
  /**
   * Concatenated columns (little-endian), compressed with raw deflate and encoded as base64. Empty on a live page.
   */
  data: string;
  /** Phase names, indexed by phase number. */
  phases: string[];
  /** Strokes in chronological order. */
  strokes: Stroke[];
}

/**
 * A column with `width` numbers per row. Number k of row r has index `r * width + k`; its value is `stored * scale`.
 * Unknown values are -32768 in columns of type i16 and NaN in columns of type f32.
 *
 * Column names (all except `time` are optional):
 * - `time` (f64): time in s, strictly increasing
 * - `phase` (u8): phase number
 * - `finger/N/joints`, a number per moving frame of the finger: angle in rad or displacement in m
 * - `finger/N/forces`, width 3 per element: x, y, z in the element's frame in N; x and y are the tangential force on
 *   the feeler by the object, z is compression, positive when pressed
 * - `finger/N/flags` (u8): bit 0 TOUCH, bit 1 SLIP, bit 2 OVER, bit 3 true slip (simulated runs only)
 * - `finger/N/contact`, width 11, in the finger's frame: centre x, y, z, long semi-axis x, y, z and short semi-axis x, y,
 *   z in m, torsion in N m, fraction of pressed elements that slide; NaN if unknown
 * - `finger/N/grasp_force` in N; `finger/N/shear_rate` in N/s
 * - `torque` in N m
 * - `frame/NAME`, width 7: pose of the frame NAME in its parent: position x, y, z in m, quaternion x, y, z, w
 * - `cap_angle` in rad
 */
export interface Column {
  name: string;
  type: "f64" | "f32" | "i16" | "u8";
  width: number;
  scale: number;
}

/** Rows of a stroke: `start` (inclusive) to `end` (exclusive). `move` is the part in which the object is turned. */
export interface Stroke {
  index: number;
  start: number;
  end: number;
  move: [number, number];
}

/** A 3-D scene. The z axis points up. Frames form a tree whose root is `world`. */
export interface Scene {
  frames: Frame[];
  shapes: Shape[];
  fingers: Finger[];
  /** Sphere that the home view shows: centre and radius in m. */
  home: { centre: Vector; radius: number };
}

export type Vector = [number, number, number];
/** Quaternion x, y, z, w. */
export type Quaternion = [number, number, number, number];

/** A frame, relative to its parent: this pose, followed by a rotation about z, or a motion along z, of the joint, if any. */
export interface Frame {
  name: string;
  parent: string;
  position: Vector;
  rotation: Quaternion;
  /**
   * Finger and place in `finger/N/joints`; a prismatic joint moves along z. A column `frame/NAME` replaces both pose and
   * joint.
   */
  joint?: { finger: number; joint: number; prismatic?: boolean };
}

/** A solid that is fixed in a frame. Lengths are in m. */
export interface Shape {
  frame: string;
  position: Vector;
  rotation: Quaternion;
  role: "link" | "dome" | "object" | "fixture";
  solid:
    | { kind: "sphere"; radius: number }
    | { kind: "box"; size: Vector }
    /** Centred, with its axis along z. */
    | { kind: "cylinder"; radius: number; length: number }
    /** Closed outline in the xy plane, extruded along z and centred in z. */
    | { kind: "prism"; outline: [number, number][]; length: number };
}

export interface Finger {
  name: string;
  /** Frame of the fingertip, in which the elements are given. */
  frame: string;
  elements: Element[];
  /** Threshold F1 (N): an element touches if its compression is above it. */
  touchForce: number;
  /** Threshold F2 (N): an element must not be pressed further if its compression is above it. */
  overForce: number;
}

/** A sensing element: its feeler's undeformed tip (m) and the rotation of its frame `E`, in the fingertip's frame. */
export interface Element {
  tip: Vector;
  rotation: Quaternion;
}

/** An interactive figure. The `<figure id="fig-NN">` of the document contains its static image and its caption. */
export interface Figure {
  number: number;
  /** Maximum number of panels side by side; 1 by default. */
  columns?: number;
  /** Panels, row by row. Panels over time share their time axis. */
  panels: Panel[];
}

export interface Panel {
  kind: "time" | "xy";
  x: Axis;
  y: Axis;
  series: Series[];
  /** Thresholds, drawn as horizontal lines; values in SI units. */
  thresholds: { value: number; name: string }[];
  /** `true` if x and y have the same scale ("xy" panels only). */
  equal?: boolean;
  /** Initially visible rows; all rows by default. */
  rows?: [number, number];
}

export interface Axis {
  /** Quantity without its unit, for example "Grasp force". */
  label: string;
  /** Displayed unit, for example "mN m"; empty for dimensionless quantities. */
  unit: string;
  /** Factor from SI units to the displayed unit. */
  scale: number;
  /** Range in SI units; by default, the range of the data. */
  range?: [number, number];
  /** `true` if the axis is logarithmic. Only for x of "xy" panels whose x values are all positive. */
  log?: boolean;
}

export interface Series {
  name: string;
  /** Colour: of a finger, of data shared by all fingers, of planned or allowed values, or of less important data. */
  colour: `finger-${0 | 1 | 2 | 3 | 4}` | "shared" | "reference" | "background";
  /** Line style. If all series of a panel are "states", each has a lane that is filled while its value is nonzero. */
  line: "solid" | "dashed" | "points" | "states";
  /** Number `index` of each row of a column, or one bit of it. Each series has either a column or points. */
  column?: { name: string; index: number; bit?: number };
  /** Explicit points. */
  points?: PointList;
}

/** Points in SI units. A line has a gap where `y` is null. Each optional list has one entry per point. */
export interface PointList {
  x: number[];
  y: (number | null)[];
  /** Bounds of the interval of `y`, drawn as a band around a line or as whiskers at points. */
  low?: (number | null)[];
  high?: (number | null)[];
  /** Row of the run to which the point belongs. */
  row?: number[];
  /** Additional text of the tooltip. */
  label?: string[];
  /** Command that reproduces a point: `pattern` with the page's folder for `{folder}` and its trial for `{trial}`. */
  command?: { pattern: string; trial: number[] };
}

/**
 * Connection of a live page. The socket sends each row as a binary message: the time as f64, followed by all numbers
 * of the other columns as f32, in column order and in SI units. (Types and scales of columns apply only to reports.)
 * It sends each {@link LiveState} as JSON text. The page sends {@link LiveOrder} and
 * {@link LiveFelt} as JSON text.
 */
export interface Live {
  /** Path of the WebSocket, including the access token. */
  socket: string;
  /** Minimum number of latest rows that the page keeps. */
  keep: number;
  /** `true` if the page can stop and resume the hand. */
  orders: boolean;
  /** `true` if the recording of the run contains the {@link LiveFelt} of the page. */
  felt: boolean;
}

export interface LiveState {
  /** State of the hand as a sentence. */
  state: string;
  stopped: boolean;
  /** Result of the last order as a sentence. */
  answer?: string;
  /** `true` if the run has ended. */
  over: boolean;
}

export interface LiveOrder {
  order: "stop" | "resume";
}

/** Rumble and tone that the page plays from now on, sent with each row and each change; zeros if nothing is played. */
export interface LiveFelt {
  felt: {
    /** Time of the row that is played (s). */
    time: number;
    /** Magnitudes of a gamepad's low- and high-frequency motor (0 to 1). */
    strong: number;
    weak: number;
    /** Frequency (Hz) and gain (0 to 1) of the tone. */
    frequency: number;
    gain: number;
  };
}
