/** A knurled cap, so that its rotation is visible. */
import { BoxGeometry, BufferGeometry, ExtrudeGeometry, Shape, Vector2 } from "three";

const KNURLS = 30;
/** Depth of a groove relative to the radius. */
const DEPTH = 0.035;

/** Knurled cylinder about z, centred; the crests are at `radius`. */
export function cap(radius: number, length: number): BufferGeometry {
  const points = Array.from({ length: 4 * KNURLS }, (_, i) => {
    const angle = (2 * Math.PI * i) / (4 * KNURLS);
    const r = radius * (i % 4 < 2 ? 1 : 1 - DEPTH);
    return new Vector2(r * Math.cos(angle), r * Math.sin(angle));
  });
  const options = { depth: length, bevelEnabled: false };
  return new ExtrudeGeometry(new Shape(points), options).translate(0, 0, -length / 2);
}

/** A bar on top of the cap from its axis to its rim, along x. */
export function capMark(radius: number, length: number): BufferGeometry {
  const width = 0.12 * radius;
  const height = 0.04 * length;
  return new BoxGeometry(0.95 * radius, width, height).translate(0.475 * radius, 0, (length + height) / 2);
}
