/** Windows of a plane, and axis transformations. */
import type { Axis } from "../page_data";

export type Range = [number, number];

export interface Window {
  x: Range;
  y: Range;
}

/** Position of a value (SI units) along an axis, in the axis' unit or as its logarithm. */
export function placeOn({ scale, log }: Axis, value: number): number {
  return log ? Math.log10(value * scale) : value * scale;
}

/** Ticks of a logarithmic axis, as logarithms: powers of ten, or 1, 2 and 5 times these on an axis of few decades. */
export function decades(low: number, high: number): number[] {
  const factors = high - low > 2.5 ? [1] : [1, 2, 5];
  const powers = Array.from(
    { length: Math.floor(high) - Math.floor(low) + 1 },
    (_, i) => Math.floor(low) + i,
  );
  const ticks = powers.flatMap((power) => factors.map((factor) => power + Math.log10(factor)));
  return ticks.filter((tick) => tick >= low - 1e-9 && tick <= high + 1e-9);
}

const middle = ([low, high]: Range) => (low + high) / 2;
const span = ([low, high]: Range) => high - low;
const around = (centre: number, width: number): Range => [centre - width / 2, centre + width / 2];

/** Window that contains all points, with a margin. */
export function windowAround(points: Iterable<readonly [number, number]>, air = 0.05): Window {
  const x: Range = [Infinity, -Infinity];
  const y: Range = [Infinity, -Infinity];
  for (const point of points) {
    widen(x, point[0]);
    widen(y, point[1]);
  }
  return { x: airy(x, air), y: airy(y, air) };
}

/** Smallest window with equal scales along x and y that contains this one, for a panel of this size (px). */
export function equalScale({ x, y }: Window, width: number, height: number): Window {
  const perPixel = Math.max(span(x) / width, span(y) / height);
  return { x: around(middle(x), perPixel * width), y: around(middle(y), perPixel * height) };
}

/** Window after a pinch from `from` to `to`, both in px along the panel's width. */
export function pinched({ x, y }: Window, width: number, from: Range, to: Range): Window {
  if (Math.abs(span(to)) < 8) return { x, y };
  const factor = span(from) / span(to);
  if (!(factor > 0.2 && factor < 5)) return { x, y };
  const under = x[0] + (middle(from) / width) * span(x);
  const left = under - (middle(to) / width) * span(x) * factor;
  return { x: [left, left + span(x) * factor], y: around(middle(y), span(y) * factor) };
}

function widen(range: Range, value: number): void {
  if (!Number.isFinite(value)) return;
  range[0] = Math.min(range[0], value);
  range[1] = Math.max(range[1], value);
}

function airy([low, high]: Range, air: number): Range {
  if (!(high >= low)) return [0, 1];
  const room = high > low ? air * (high - low) : 0.5 * Math.abs(high) || 0.5;
  return [low - room, high + room];
}
