/** How the camera in a fingertip sees an element: the dome from inside, along its axis outward. */
import type { Element, Quaternion, Vector } from "../page_data";

/** Where the pinhole is behind the dome's centre, of the dome's radius. */
const STANDOFF = 0.55;
/** Area of a spot pressed with 1 N, relative to that of one that is not pressed, beyond 1. */
const GAIN = 9;
/** How far a shear of 1 N moves a spot, of the dome's radius: more than in truth, to be seen. */
const SHIFT = 0.25;

/** An element in the picture. The picture's edge is at 1, y goes up. */
export interface Spot {
  x: number;
  y: number;
  /** What a tangential force of 1 N along x and y of the element's frame moves it by. */
  shear: [x: [number, number], y: [number, number]];
}

/** The elements, unpressed. */
export function spots(elements: Element[]): Spot[] {
  const radius = Math.max(1e-6, ...elements.map(({ tip }) => Math.hypot(...tip)));
  const largest = Math.max(1e-6, ...elements.map(({ tip }) => Math.hypot(...project(tip, radius))));
  const edge = 1.2 * largest;
  const seen = (point: Vector): [number, number] => {
    const [x, y] = project(point, radius);
    return [x / edge, y / edge];
  };
  return elements.map(({ tip, rotation }) => {
    const [x, y] = seen(tip);
    const moved = (axis: Vector): [number, number] => {
      const along = rotated(rotation, axis);
      const [px, py] = seen(tip.map((t, k) => t + SHIFT * radius * (along[k] ?? 0)) as Vector);
      return [px - x, py - y];
    };
    return { x, y, shear: [moved([1, 0, 0]), moved([0, 1, 0])] };
  });
}

/** A spot's radius relative to that of an unpressed one: its area grows with the compression, N. */
export function growth(compression: number): number {
  return Math.sqrt(1 + GAIN * Math.max(0, compression));
}

/** A pinhole that looks along x, with z up: y is on the left. */
function project([x, y, z]: Vector, radius: number): [number, number] {
  const depth = Math.max(x + STANDOFF * radius, 0.05 * radius);
  return [-y / depth, z / depth];
}

/** A vector turned by a quaternion. */
function rotated([x, y, z, w]: Quaternion, [a, b, c]: Vector): Vector {
  const [tx, ty, tz] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
  return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
}
