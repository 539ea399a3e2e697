/** Sample figures that are not functions of time. */
import type { Panel } from "../src/page_data";
import { CAP } from "./contact";
import { BASES, tipPose } from "./hand";
import type { Simulated } from "./simulate";

const millimetres = (label: string) => ({ label, unit: "mm", scale: 1e3 });

/** Top view of the dome centres in the last stroke, with the cap. */
export function paths({ rows, strokes }: Simulated): Panel {
  const stroke = strokes.at(-1);
  const moving = Array.from(
    { length: (stroke?.end ?? 0) - (stroke?.start ?? 0) },
    (_, i) => i + (stroke?.start ?? 0),
  );
  const circle = Array.from({ length: 121 }, (_, i) => (2 * Math.PI * i) / 120);
  return {
    kind: "xy",
    x: millimetres("x"),
    y: millimetres("y"),
    equal: true,
    series: [
      {
        name: "cap",
        colour: "shared",
        line: "solid",
        points: {
          x: circle.map((a) => CAP.radius * Math.cos(a)),
          y: circle.map((a) => CAP.radius * Math.sin(a)),
        },
      },
      ...BASES.map((base, f) => {
        const centres = moving.map((row) => {
          const [a = 0, b = 0, c = 0] = rows[row]?.joints[f] ?? [];
          return tipPose(base, [a, b, c]).elements;
        });
        return {
          name: `dome's centre, finger ${f}`,
          colour: `finger-${f}` as "finger-0",
          line: "solid" as const,
          points: { x: centres.map((m) => m[12]), y: centres.map((m) => m[13]), row: moving },
        };
      }),
    ],
    thresholds: [],
  };
}

/** Trials of a sweep with their commands. */
export function scatter(): Panel {
  const seeds = Array.from({ length: 60 }, (_, seed) => seed);
  const noise = (seed: number, k: number) => Math.abs(Math.sin(12.9898 * seed + 78.233 * k) * 43758.5453) % 1;
  return {
    kind: "xy",
    x: { label: "Friction", unit: "", scale: 1 },
    y: { label: "Closing torque", unit: "mN·m", scale: 1e3 },
    series: [
      {
        name: "trials",
        colour: "finger-0",
        line: "points",
        points: {
          x: seeds.map((seed) => 1.08 + 0.12 * noise(seed, 1)),
          y: seeds.map((seed) => 0.02 + 0.012 * noise(seed, 1) + 0.006 * noise(seed, 2)),
          command: { pattern: "feeler run --trial {folder} {trial}", trial: seeds },
        },
      },
    ],
    thresholds: [{ value: 0.025, name: "target" }],
  };
}
