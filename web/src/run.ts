/** A recorded or live run: typed access to its columns, phases and strokes. */
import type { Finger, RunTable, Stroke, Vector } from "./page_data";
import type { Column, Table } from "./table";

/** Bits of `finger/N/flags`. */
export const TOUCH = 1;
export const SLIP = 2;
export const OVER = 4;

export const FLAG_NAMES: readonly [bit: number, name: string][] = [
  [TOUCH, "TOUCH"],
  [SLIP, "SLIP"],
  [OVER, "OVER"],
];

/** Contact of a finger with an object; vectors are in the finger's frame. Unknown values are NaN. */
export interface Contact {
  /** Centre of pressure (m). */
  centre: Vector;
  /** Semi-axes of the contact area (m). */
  axes: [long: Vector, short: Vector];
  /** Torque on the fingertip about its normal (N m). */
  torsion: number;
  /** Fraction of the elements pressed with three times the threshold or more that slide. */
  sliding: number;
}

/** Recorded columns of one finger. */
export class FingerColumns {
  readonly forces: Column | undefined;
  readonly graspForce: Column | undefined;
  readonly shearRate: Column | undefined;
  readonly #flags: Column | undefined;
  readonly #contact: Column | undefined;

  constructor(
    table: Table,
    readonly number: number,
    readonly finger: Finger,
  ) {
    this.forces = table.column(`finger/${number}/forces`);
    this.graspForce = table.column(`finger/${number}/grasp_force`);
    this.shearRate = table.column(`finger/${number}/shear_rate`);
    this.#flags = table.column(`finger/${number}/flags`);
    this.#contact = table.column(`finger/${number}/contact`);
  }

  /** `true` if contacts are recorded. */
  get hasContact(): boolean {
    return this.#contact !== undefined;
  }

  /** Contact at a row; `undefined` if nothing touches. */
  contact(row: number): Contact | undefined {
    const value = (k: number) => this.#contact?.at(row, k) ?? NaN;
    const vector = (k: number): Vector => [value(k), value(k + 1), value(k + 2)];
    const centre = vector(0);
    if (!Number.isFinite(centre[0])) return undefined;
    return { centre, axes: [vector(3), vector(6)], torsion: value(9), sliding: value(10) };
  }

  flags(row: number): number {
    return this.#flags?.at(row) || 0;
  }

  /** Compression of an element (N); 0 if it is unknown. */
  compression(row: number, element: number): number {
    return this.forces?.at(row, 3 * element + 2) || 0;
  }
}

export class Run {
  readonly strokes: Stroke[];
  readonly #phases: string[];
  readonly #phase: Column | undefined;

  constructor(
    readonly table: Table,
    { strokes, phases }: RunTable,
  ) {
    this.strokes = strokes;
    this.#phases = phases;
    this.#phase = table.column("phase");
  }

  phase(row: number): string {
    return this.#phases[this.phaseNumber(row)] ?? "";
  }

  /** Phase number at a row; -1 if it is unknown. */
  phaseNumber(row: number): number {
    return this.#phase?.at(row) ?? -1;
  }

  stroke(row: number): Stroke | undefined {
    return this.strokes.find((stroke) => stroke.start <= row && row < stroke.end);
  }

  /** Phase and stroke at a row, for example "MOVE, stroke 2". */
  describe(row: number): string {
    const stroke = this.stroke(row);
    return [this.phase(row), stroke && `stroke ${stroke.index}`].filter(Boolean).join(", ");
  }
}
