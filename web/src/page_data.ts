/**
 * What a page is made of: the contract between `feeler-report`, which writes it into the document, and this program,
 * which draws it. `crates/feeler-report/src/page_data` holds the same structs; `test/examples.ts` is what pages hold, which
 * a test of Rust compares and the compiler checks against these types.
 *
 * The document holds one `<script type="application/json" id="page-data">` with a {@link PageData}. Units are SI; a
 * figure says how its values are scaled for the eye.
 */
export interface PageData {
  /** Number of this contract; another one is refused in words. */
  version: 1;
  /** What the page is about: "cap-closing, seed 0". */
  title: string;
  /** What was recorded at every row, if the page is about one run. */
  run?: RunTable;
  /** The 3-D scene, if the page is about one run. */
  scene?: Scene;
  figures: Figure[];
  /** Where the rows come from while the rig works; none in a report. */
  live?: Live;
}

/** Rows of a run, one per control step or fewer, as columns. */
export interface RunTable {
  rows: number;
  columns: Column[];
  /**
   * All columns, one after the other, little endian, compressed by raw deflate, in base64. Empty on a live page.
   */
  data: string;
  /** Names of phases by number. */
  phases: string[];
  /** The strokes, in the order of time. */
  strokes: Stroke[];
}

/**
 * A column: `width` numbers a row. Row r's k-th number stands at r * width + k, and is `stored * scale`. The smallest
 * i16 (-32768) and f32's NaN stand for what is not known.
 *
 * Names, each of which may be missing:
 * - `time` (f64), s; strictly rising
 * - `phase` (u8), number of a phase
 * - `finger/N/joints`, 3, rad
 * - `finger/N/forces`, 3 for each element: x, y, z in the element's frame, N; on the feeler by the object, but z is
 *   compression, positive when pressed
 * - `finger/N/flags` (u8): bit 0 TOUCH, bit 1 SLIP, bit 2 OVER, bit 3 slips in truth (only a simulator knows)
 * - `finger/N/grasp_force`, N; `finger/N/shear_rate`, N/s
 * - `torque`, N m
 * - `frame/NAME`, 7: position x y z in m and rotation as quaternion x y z w of the frame NAME in its parent
 * - `cap_angle`, rad
 */
export interface Column {
  name: string;
  type: "f64" | "f32" | "i16" | "u8";
  width: number;
  scale: number;
}

/** Rows of a stroke: from `start` up to, not including, `end`; `move` is the part of it in which the object is turned. */
export interface Stroke {
  index: number;
  start: number;
  end: number;
  move: [number, number];
}

/** z is up. Frames form a tree whose root is `world`. */
export interface Scene {
  frames: Frame[];
  shapes: Shape[];
  fingers: Finger[];
  /** What the home view shows: centre and radius, m. */
  home: { centre: Vector; radius: number };
}

export type Vector = [number, number, number];
/** x, y, z, w. */
export type Quaternion = [number, number, number, number];

/** A frame in its parent: this pose, then, where it has a joint, turned about its z by that joint's angle. */
export interface Frame {
  name: string;
  parent: string;
  position: Vector;
  rotation: Quaternion;
  /** Finger and joint (0 to 2) of `finger/N/joints`. Where a column `frame/NAME` is, that is the pose instead. */
  joint?: { finger: number; joint: number };
}

/** A solid in a frame; lengths in m. */
export interface Shape {
  frame: string;
  position: Vector;
  rotation: Quaternion;
  role: "link" | "dome" | "object" | "fixture";
  solid:
    | { kind: "sphere"; radius: number }
    | { kind: "box"; size: Vector }
    /** About z, centred. */
    | { kind: "cylinder"; radius: number; length: number }
    /** A closed outline in x and y, extruded along z, centred. */
    | { kind: "prism"; outline: [number, number][]; length: number };
}

export interface Finger {
  name: string;
  /** The frame that the elements are in. */
  frame: string;
  elements: Element[];
  /** F1: an element pressed harder than this touches, N. */
  touchForce: number;
  /** F2: an element pressed harder than this must not be pressed further, N. */
  overForce: number;
}

/** A sensing element: its feeler's undeformed tip in the finger's frame, m, and the element's frame `E` there. */
export interface Element {
  tip: Vector;
  rotation: Quaternion;
}

/** A figure. `#fig-NN` in the document is its `<figure>`, which has the still picture and the caption. */
export interface Figure {
  number: number;
  /** How many panels stand side by side, where there is room; one, if not given. */
  columns?: number;
  /** Row by row; panels of time share their axis. */
  panels: Panel[];
}

export interface Panel {
  kind: "time" | "xy";
  x: Axis;
  y: Axis;
  series: Series[];
  /** Horizontal lines, in SI units: thresholds. */
  thresholds: { value: number; name: string }[];
  /** Of "xy": the same scale along x and y. */
  equal?: boolean;
  /** Rows that are shown at first, if not all. */
  rows?: [number, number];
}

export interface Axis {
  /** What is shown, without its unit: "Grasp force". */
  label: string;
  /** As it stands behind a value: "mN m". Empty where there is none. */
  unit: string;
  /** What a value in SI units is multiplied by. */
  scale: number;
  /** In SI units; what there is to see, if not given. */
  range?: [number, number];
  /** Whether equal distances stand for equal ratios. Only along x of "xy"; every value is more than 0. */
  log?: boolean;
}

export interface Series {
  name: string;
  /** Colours: finger 0, finger 1 ..., what all share, what is planned or allowed, what is in the background. */
  colour: `finger-${0 | 1 | 2 | 3 | 4}` | "shared" | "reference" | "background";
  /** A panel whose series are all "states" has a lane for each, filled while its value is not 0. */
  line: "solid" | "dashed" | "points" | "states";
  /** Either the k-th number of a column, for each row ... */
  column?: { name: string; index: number; bit?: number };
  /** ... or points of its own. */
  points?: PointList;
}

/** Points in SI units; where `y` is not known, a line is interrupted. What else there is has an entry for each point. */
export interface PointList {
  x: number[];
  y: (number | null)[];
  /** Ends of the interval that `y` stands in: a band about a line, whiskers at points. */
  low?: (number | null)[];
  high?: (number | null)[];
  /** The row of the run that it belongs to. */
  row?: number[];
  /** What else is to be said of it. */
  label?: string[];
  /** The command that shows it: `pattern` with the page's folder for `{folder}` and the point's trial for `{trial}`. */
  command?: { pattern: string; trial: number[] };
}

/**
 * A live page. Messages of the socket are binary: time (f64), then every number of every other column as f32, in the
 * columns' order, in SI units (a column's type and scale are those of a report); or JSON text: {@link LiveState}. The page sends {@link LiveOrder}.
 */
export interface Live {
  /** Path of the WebSocket, with its token. */
  socket: string;
  /** Rows that the page keeps. */
  keep: number;
  /** Whether there is somebody who can be told to stop. */
  orders: boolean;
}

export interface LiveState {
  /** What the hand is about, in words. */
  state: string;
  stopped: boolean;
  /** Of the last order: what came of it, in words. */
  answer?: string;
  /** Whether this is the end. */
  over: boolean;
}

export interface LiveOrder {
  order: "stop" | "resume";
}
