/** Data of the sample pages. */
import type { Figure, Live, PageData, Panel, Scene, Series } from "../src/page_data";
import { CAP } from "./contact";
import { runTable } from "./encode";
import { BASES, elements, frames, shapes } from "./hand";
import { OVER_FORCE, type Simulated, TOUCH_FORCE } from "./simulate";
import { paths, scatter } from "./plane_figures";

const FINGERS = BASES.length;

export function scene(): Scene {
  return {
    frames: [
      ...BASES.flatMap((base, finger) => frames(finger, base)),
      { name: "cap", parent: "world", position: [0, 0, 0.1], rotation: [0, 0, 0, 1] },
    ],
    shapes: [
      ...BASES.flatMap((_, finger) => shapes(finger)),
      {
        frame: "cap",
        position: [0, 0, 0],
        rotation: [0, 0, 0, 1],
        role: "object",
        solid: { kind: "cylinder", radius: CAP.radius, length: CAP.height },
      },
      {
        frame: "world",
        position: [0, 0, 0.06],
        rotation: [0, 0, 0, 1],
        role: "fixture",
        solid: { kind: "cylinder", radius: 0.0125, length: 0.058 },
      },
    ],
    fingers: BASES.map((_, finger) => ({
      name: `finger ${finger}`,
      frame: `finger/${finger}/tip`,
      elements: elements(),
      touchForce: TOUCH_FORCE,
      overForce: OVER_FORCE,
    })),
    home: { centre: [0, 0, 0.097], radius: 0.055 },
  };
}

const time = { label: "Time", unit: "s", scale: 1 };
const fingers = (column: string): Series[] =>
  BASES.map((_, f) => ({
    name: `finger ${f}`,
    colour: `finger-${f}` as Series["colour"],
    line: "solid",
    column: { name: `finger/${f}/${column}`, index: 0 },
  }));

const graspForce: Panel = {
  kind: "time",
  x: time,
  y: { label: "Grasp force", unit: "N", scale: 1 },
  series: fingers("grasp_force"),
  thresholds: [{ value: 1, name: "grasp threshold" }],
};

const torque: Panel = {
  kind: "time",
  x: time,
  y: { label: "Torque", unit: "mN·m", scale: 1e3 },
  series: [{ name: "torque", colour: "shared", line: "solid", column: { name: "torque", index: 0 } }],
  thresholds: [],
};

const shearRate: Panel = {
  kind: "time",
  x: time,
  y: { label: "Shear rate", unit: "N/s", scale: 1, range: [0, 12] },
  series: fingers("shear_rate"),
  thresholds: [{ value: 6.5, name: "slip threshold" }],
};

const states: Panel = {
  kind: "time",
  x: time,
  y: { label: "Slip", unit: "", scale: 1 },
  series: BASES.flatMap((_, f): Series[] => [
    {
      name: `SLIP of finger ${f}`,
      colour: `finger-${f}` as Series["colour"],
      line: "states",
      column: { name: `finger/${f}/flags`, index: 0, bit: 1 },
    },
    {
      name: `true slip of finger ${f}`,
      colour: "shared",
      line: "states",
      column: { name: `finger/${f}/flags`, index: 0, bit: 3 },
    },
  ]),
  thresholds: [],
};

export function figures(run: Simulated): Figure[] {
  const fourth = run.strokes[3];
  const rows: [number, number] | undefined = fourth && [fourth.start, fourth.end - 1];
  return [
    { number: 8, panels: [graspForce, torque] },
    { number: 9, panels: [shearRate, torque] },
    { number: 11, panels: [shearRate, states, torque].map((panel) => (rows ? { ...panel, rows } : panel)) },
    { number: 13, panels: [paths(run)] },
    { number: 14, panels: [scatter()] },
  ];
}

export function reportData(run: Simulated): PageData {
  return {
    version: 1,
    title: "cap-closing, sample",
    run: runTable(run, FINGERS, elements().length),
    scene: scene(),
    figures: figures(run),
  };
}

export function liveData(run: Simulated, live: Live): PageData {
  const { rows: _, ...table } = runTable(run, FINGERS, elements().length);
  return {
    version: 1,
    title: "cap-closing, live sample",
    run: { ...table, rows: 0, data: "", strokes: [] },
    scene: scene(),
    figures: [
      { number: 1, panels: [graspForce, torque] },
      { number: 2, panels: [shearRate, states] },
    ],
    live,
  };
}
