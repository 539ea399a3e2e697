/** Solids of a scene: links, domes, the object and fixtures. */
import {
  BoxGeometry,
  BufferGeometry,
  CylinderGeometry,
  EdgesGeometry,
  ExtrudeGeometry,
  Group,
  LineSegments,
  Mesh,
  Shape as Outline,
  SphereGeometry,
  Vector2,
} from "three";
import type { Shape } from "../page_data";
import { cap, capMark } from "./cap";
import type { FrameTree } from "./frames";
import type { Palette } from "./palette";

type Solid = Shape["solid"];

/** A solid that moves with its frame. */
export function solid(shape: Shape, finger: number | undefined, frames: FrameTree, palette: Palette): Group {
  const inFrame = new Group();
  inFrame.position.set(...shape.position);
  inFrame.quaternion.set(...shape.rotation);
  inFrame.add(...parts(shape, finger, palette));
  const group = new Group();
  group.matrixAutoUpdate = false;
  group.matrix = frames.world(shape.frame);
  group.add(inFrame);
  return group;
}

function parts(shape: Shape, finger: number | undefined, palette: Palette) {
  switch (shape.role) {
    case "dome":
      return [new Mesh(geometry(shape.solid), palette.dome(finger ?? 0))];
    case "link":
      return [new Mesh(geometry(shape.solid), palette.link(finger))];
    case "fixture":
      return [new Mesh(geometry(shape.solid), palette.fixture)];
    case "object":
      return object(shape.solid, palette);
  }
}

/** The object with its contour. Round objects get knurls and a mark that make their rotation visible. */
function object(solid: Solid, palette: Palette) {
  const round = solid.kind === "cylinder";
  const body = new Mesh(round ? cap(solid.radius, solid.length) : geometry(solid), palette.object);
  const contour = new LineSegments(new EdgesGeometry(geometry(solid), 30), palette.contour);
  return round
    ? [body, contour, new Mesh(capMark(solid.radius, solid.length), palette.mark)]
    : [body, contour];
}

function geometry(solid: Solid): BufferGeometry {
  switch (solid.kind) {
    case "sphere":
      return new SphereGeometry(solid.radius, 40, 24);
    case "box":
      return new BoxGeometry(...solid.size);
    case "cylinder":
      // Cylinders of three.js are about y; here they are about z.
      return new CylinderGeometry(solid.radius, solid.radius, solid.length, 64).rotateX(Math.PI / 2);
    case "prism": {
      const outline = new Outline(solid.outline.map(([x, y]) => new Vector2(x, y)));
      const options = { depth: solid.length, bevelEnabled: false };
      return new ExtrudeGeometry(outline, options).translate(0, 0, -solid.length / 2);
    }
  }
}
