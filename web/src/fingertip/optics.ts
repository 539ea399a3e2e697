/** Camera model of a fingertip: the dome seen from inside, along its axis outward. */
import type { Element, Quaternion, Vector } from "../page_data";

/** Distance of the pinhole behind the dome's centre, relative to the dome's radius. */
const STANDOFF = 0.55;
/** Relative growth of a spot's area per newton. */
const GAIN = 9;
/** Displacement of a spot per newton of shear, relative to the dome's radius; exaggerated for visibility. */
const SHIFT = 0.25;

/** Spot of an element in the image. The edge of the image is at 1; y points up. */
export interface Spot {
  x: number;
  y: number;
  /** Displacement of the spot per newton of tangential force along x and y of the element's frame. */
  shear: [x: [number, number], y: [number, number]];
}

/** Projection of a point in the finger's frame (m) to the image, whose edge is at 1. */
export type Camera = (point: Vector) => [x: number, y: number];

/** Camera that sees all elements. */
export function camera(elements: Element[]): Camera {
  const radius = domeRadius(elements);
  const largest = Math.max(1e-6, ...elements.map(({ tip }) => Math.hypot(...project(tip, radius))));
  const edge = 1.2 * largest;
  return (point) => {
    const [x, y] = project(point, radius);
    return [x / edge, y / edge];
  };
}

function domeRadius(elements: Element[]): number {
  return Math.max(1e-6, ...elements.map(({ tip }) => Math.hypot(...tip)));
}

/** Spots of the unloaded elements. */
export function spots(elements: Element[], seen: Camera = camera(elements)): Spot[] {
  const radius = domeRadius(elements);
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

/** Radius of a spot relative to an unloaded one. The area grows with the compression (N). */
export function growth(compression: number): number {
  return Math.sqrt(1 + GAIN * Math.max(0, compression));
}

/** Pinhole projection along x, with z up and y to the left. */
function project([x, y, z]: Vector, radius: number): [number, number] {
  const depth = Math.max(x + STANDOFF * radius, 0.05 * radius);
  return [-y / depth, z / depth];
}

/** Rotates a vector by a quaternion. */
function rotated([x, y, z, w]: Quaternion, [a, b, c]: Vector): Vector {
  const [tx, ty, tz] = [2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)];
  return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
}
