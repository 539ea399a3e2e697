/**
 * Synthetic run for tests and sample pages: two fingers close a cap in several strokes. Independent of feeler's
 * simulator.
 */
import { Vector3 } from "three";
import type { Stroke } from "../src/page_data";
import { CAP, Contact } from "./contact";
import { BASES, elements, jointsAt, tipPose } from "./hand";

export const PERIOD = 0.01;
export const PHASES = ["SEARCH", "MOVE", "RELEASE", "RETURN"];
export const TOUCH_FORCE = 0.1;
export const OVER_FORCE = 0.505;
/** Sections of a stroke: duration (s) and phase. The fingers close, press, turn, open and return. */
const DURATIONS = [0.9, 0.6, 1.3, 0.7, 1.3];
const PHASE_OF = [0, 0, 1, 2, 3];
const TURNING = 2;
const [SEAT, SEAT_STIFFNESS, RUNNING_TORQUE, LEAD] = [1.15, 0.09, 0.0021, 0.00318];

export interface Row {
  time: number;
  phase: number;
  joints: number[][];
  forces: number[][];
  flags: number[];
  graspForce: number[];
  shearRate: number[];
  torque: number;
  capAngle: number;
  capHeight: number;
}

export interface Simulated {
  rows: Row[];
  strokes: Stroke[];
}

export function simulate(count: number): Simulated {
  const layout = elements();
  const contacts = BASES.map(() => new Contact(layout));
  const rows: Row[] = [];
  const strokes: Stroke[] = [];
  let cap = 0;
  let turned = 0;
  for (let index = 1; index <= count; index++) {
    const start = rows.length;
    const starts: number[] = [];
    DURATIONS.forEach((duration, section) => {
      starts.push(rows.length);
      for (let step = 0; step < Math.round(duration / PERIOD); step++) {
        const part = (step * PERIOD) / duration;
        const row = takeRow(contacts, section, part, cap, turned, rows.at(-1));
        row.time = rows.length * PERIOD;
        rows.push(row);
        // The excess of the fingers' torque over the resisting torque turns the cap.
        const resisting = RUNNING_TORQUE + Math.max(0, cap - SEAT) * SEAT_STIFFNESS;
        turned = section === TURNING ? Math.max(0, Math.min(0.007, (row.torque - resisting) * 2)) : 0;
        cap += turned;
      }
    });
    strokes.push({ index, start, end: rows.length, move: [starts[TURNING] ?? 0, starts[TURNING + 1] ?? 0] });
  }
  return { rows, strokes };
}

function takeRow(
  contacts: Contact[],
  section: number,
  part: number,
  cap: number,
  turned: number,
  before: Row | undefined,
): Row {
  const capHeight = 0.1 - (LEAD * cap) / (2 * Math.PI);
  const fingers = BASES.map((base, i) => {
    const joints = jointsAt(base, centre(i === 0 ? 1 : -1, section, part));
    const felt = contacts[i]?.step(tipPose(base, joints), capHeight, turned);
    return {
      joints: [...joints],
      forces: felt?.forces ?? [],
      slips: felt?.slips ?? false,
      torque: felt?.torque ?? 0,
    };
  });
  const hardest = fingers.map(({ forces }) => Math.max(...forces.filter((_, k) => k % 3 === 2)));
  const rates = fingers.map(({ forces }, i) => shearRate(forces, before?.forces[i]));
  return {
    time: 0,
    phase: PHASE_OF[section] ?? 0,
    joints: fingers.map(({ joints }) => joints),
    forces: fingers.map(({ forces }) => forces),
    flags: fingers.map(({ slips }, i) => flags(hardest[i] ?? 0, (rates[i] ?? 0) > 6.5, slips)),
    graspForce: fingers.map(({ forces }) => forces.reduce((sum, f, k) => (k % 3 === 2 ? sum + f : sum), 0)),
    shearRate: rates,
    torque: fingers.reduce((sum, { torque }) => sum + torque, 0),
    capAngle: cap,
    capHeight,
  };
}

const flags = (hardest: number, slip: boolean, truth: boolean): number =>
  (hardest > TOUCH_FORCE ? 1 : 0) + (slip ? 2 : 0) + (hardest > OVER_FORCE ? 4 : 0) + (truth ? 8 : 0);

/** Position of a dome's centre on its rectangular path, for the left (side 1) or right (side -1) finger. */
function centre(side: 1 | -1, section: number, part: number): Vector3 {
  const [far, near] = [0.038, CAP.radius + 0.018 - 0.0005];
  const [high, low] = [0.0042, -0.0051];
  const smooth = part * part * (3 - 2 * part);
  const between = (a: number, b: number) => a + (b - a) * smooth;
  const at = [
    () => [between(far, near + 0.001), high],
    () => [between(near + 0.001, near), high],
    () => [near - 0.0006 * Math.sin(Math.PI * smooth) - 0.0004 * smooth, between(high, low)],
    () => [between(near - 0.0004, far), low],
    () => [far, between(low, high)],
  ][section];
  const [x = far, y = high] = at?.() ?? [];
  return new Vector3(-side * x, side * y, 0.1);
}

/** Rate of change of the shear force on the most compressed element (N/s). */
function shearRate(now: number[], before: number[] | undefined): number {
  let hardest = 2;
  for (let k = 2; k < now.length; k += 3) if ((now[k] ?? 0) > (now[hardest] ?? 0)) hardest = k;
  const shear = (forces: number[]) => Math.hypot(forces[hardest - 2] ?? 0, forces[hardest - 1] ?? 0);
  return before ? Math.abs(shear(now) - shear(before)) / PERIOD : 0;
}
