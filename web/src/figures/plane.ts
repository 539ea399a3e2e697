/** Parts of a plane that a panel shows. */

export type Range = [number, number];

export interface Window {
  x: Range;
  y: Range;
}

const middle = ([low, high]: Range) => (low + high) / 2;
const span = ([low, high]: Range) => high - low;
const around = (centre: number, width: number): Range => [centre - width / 2, centre + width / 2];

/** What holds all points, with some air. */
export function windowAround(points: Iterable<readonly [number, number]>, air = 0.05): Window {
  const x: Range = [Infinity, -Infinity];
  const y: Range = [Infinity, -Infinity];
  for (const point of points) {
    widen(x, point[0]);
    widen(y, point[1]);
  }
  return { x: airy(x, air), y: airy(y, air) };
}

/** The smallest window of one scale along x and y that holds this one, on a panel so many pixels wide and high. */
export function equalScale({ x, y }: Window, width: number, height: number): Window {
  const perPixel = Math.max(span(x) / width, span(y) / height);
  return { x: around(middle(x), perPixel * width), y: around(middle(y), perPixel * height) };
}

/** The window about which two fingers, at `from` on the panel's width before and at `to` now, have closed or opened. */
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
