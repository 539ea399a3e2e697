/** Contents of a scene, and their appearance at a row. */
import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  DirectionalLight,
  HemisphereLight,
  LineSegments,
  Scene as ThreeScene,
} from "three";
import type { Scene, Shape } from "../page_data";
import type { FingerColumns, Run } from "../run";
import { fingerColour } from "../ui/colours";
import { Elements } from "./elements";
import { FrameTree } from "./frames";
import { Palette } from "./palette";
import { solid } from "./solids";
import { Trail } from "./trails";

/** Spacing of the floor grid (m). */
export const GRID = 0.01;

export class Model {
  readonly scene = new ThreeScene();
  readonly #run: Run;
  readonly #frames: FrameTree;
  readonly #palette = new Palette();
  readonly #elements: Elements[];
  readonly #trails: Trail[];

  constructor(scene: Scene, run: Run, fingers: FingerColumns[]) {
    this.#run = run;
    this.#frames = new FrameTree(scene, run.table);
    const owners = fingerOfFrames(scene);
    const solids = scene.shapes.map((shape) =>
      solid(shape, owners.get(shape.frame), this.#frames, this.#palette),
    );
    this.#elements = fingers.map((columns) => new Elements(columns, this.#frames, this.#palette));
    this.#trails = fingers.map((columns) => new Trail(columns, run));
    this.scene.add(...solids, ...this.#elements.map((elements) => elements.group));
    this.scene.add(...this.#trails.map((trail) => trail.points));
    this.scene.add(floor(scene, this.#palette));
    this.scene.add(...lights());
    // Groups use the matrices of the frame tree; three.js only updates world matrices.
    this.scene.matrixWorldAutoUpdate = true;
  }

  paint(dark: boolean): void {
    this.#palette.paint(dark);
    this.#trails.forEach((trail, finger) => trail.points.material.color.set(fingerColour(finger, dark)));
  }

  moveTo(row: number): void {
    if (this.#run.table.length === 0) return;
    this.#extendTrails();
    this.#frames.moveTo(row);
    for (const elements of this.#elements) elements.show(row);
    for (const trail of this.#trails) trail.show(row);
  }

  /** Clears the trails after the oldest rows were removed. */
  forgetTrails(): void {
    for (const trail of this.#trails) trail.clear();
  }

  #extendTrails(): void {
    const end = this.#run.table.length;
    for (let row = this.#trails[0]?.rows ?? end; row < end; row++) {
      this.#frames.moveTo(row);
      for (const trail of this.#trails) trail.add(this.#frames);
    }
  }
}

/** Finger that each frame belongs to, according to the joints that move it. */
function fingerOfFrames(scene: Scene): Map<string, number> {
  const owners = new Map<string, number>();
  for (const frame of scene.frames) {
    const owner = frame.joint?.finger ?? owners.get(frame.parent);
    if (owner !== undefined) owners.set(frame.name, owner);
  }
  scene.fingers.forEach((finger, number) => owners.set(finger.frame, number));
  return owners;
}

/** Floor grid at the lowest point of the fixtures, as a length scale. */
function floor(scene: Scene, palette: Palette): LineSegments {
  const { centre, radius } = scene.home;
  const lines = Math.ceil(radius / GRID);
  const reach = lines * GRID;
  const points: number[] = [];
  for (let i = -lines; i <= lines; i++) {
    points.push(i * GRID, -reach, 0, i * GRID, reach, 0, -reach, i * GRID, 0, reach, i * GRID, 0);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
  const grid = new LineSegments(geometry, palette.grid);
  grid.position.set(centre[0], centre[1], lowest(scene.shapes) ?? centre[2] - radius / 2);
  return grid;
}

/** Lowest z of the fixtures in the world. */
function lowest(shapes: Shape[]): number | undefined {
  const fixtures = shapes.filter((shape) => shape.role === "fixture" && shape.frame === "world");
  const bottoms = fixtures.map(({ position: [, , z], solid }) => {
    if (solid.kind === "box") return z - solid.size[2] / 2;
    return solid.kind === "sphere" ? z - solid.radius : z - solid.length / 2;
  });
  return bottoms.length ? Math.min(...bottoms) : undefined;
}

function lights() {
  const key = new DirectionalLight(0xffffff, 1.6);
  key.position.set(-0.6, -1, 1.6);
  return [new HemisphereLight(0xffffff, 0x8a8f96, 1.1), new AmbientLight(0xffffff, 0.5), key];
}
