/** Sensing elements of a finger and their forces, as three instanced meshes. */
import {
  Color,
  ConeGeometry,
  CylinderGeometry,
  DynamicDrawUsage,
  Group,
  InstancedMesh,
  Matrix4,
  MeshLambertMaterial,
  Quaternion,
  SphereGeometry,
  Vector3,
} from "three";
import type { Element } from "../page_data";
import { SLIP, type FingerColumns } from "../run";
import { OVER_COLOUR, SLIP_COLOUR, TOUCH_COLOUR } from "../ui/colours";
import type { FrameTree } from "./frames";
import type { Palette } from "./palette";

/** Length of an arrow (m/N). */
export const ARROW_LENGTH = 0.04;
/** Displacement of a feeler's tip, relative to the dome's radius per newton; similar to the reference fingertip. */
const YIELD = 0.27;
/** Forces up to this value are noise (N). */
const LEAST_FORCE = 0.01;
const Z = new Vector3(0, 0, 1);

const touching = new Color(TOUCH_COLOUR);
const slipping = new Color(SLIP_COLOUR);
const pressedTooHard = new Color(OVER_COLOUR);

export class Elements {
  /** Group in the finger's frame. */
  readonly group = new Group();
  readonly #columns: FingerColumns;
  readonly #palette: Palette;
  readonly #size: number;
  readonly #spots: InstancedMesh;
  readonly #shafts: InstancedMesh;
  readonly #heads: InstancedMesh;
  readonly #rotations: Quaternion[];
  // Reused objects, so that playback does not allocate.
  readonly #matrix = new Matrix4();
  readonly #force = new Vector3();
  readonly #tip = new Vector3();
  readonly #middle = new Vector3();
  readonly #scale = new Vector3();
  readonly #turn = new Quaternion();

  constructor(columns: FingerColumns, frames: FrameTree, palette: Palette) {
    const { elements, frame } = columns.finger;
    this.#columns = columns;
    this.#palette = palette;
    this.#size = elementSize(elements);
    this.#rotations = elements.map((element) => new Quaternion(...element.rotation));
    const arrow = palette.arrow(columns.number);
    const thickness = 0.35 * this.#size;
    const shaft = new CylinderGeometry(thickness, thickness, 1, 8).rotateX(Math.PI / 2);
    const head = new ConeGeometry(2.4 * thickness, 6 * thickness, 12).rotateX(Math.PI / 2);
    this.#spots = instances(
      new SphereGeometry(this.#size, 12, 8),
      new MeshLambertMaterial(),
      elements.length,
    );
    this.#shafts = instances(shaft, arrow, elements.length);
    this.#heads = instances(head.translate(0, 0, -3 * thickness), arrow, elements.length);
    this.group.matrixAutoUpdate = false;
    this.group.matrix = frames.world(frame);
    this.group.add(this.#spots, this.#shafts, this.#heads);
  }

  show(row: number): void {
    const slips = (this.#columns.flags(row) & SLIP) !== 0;
    let arrows = 0;
    this.#columns.finger.elements.forEach((element, i) => {
      this.#showSpot(element, i, row, slips);
      if (this.#placeArrow(element, i, row)) this.#writeArrow(arrows++);
    });
    this.#shafts.count = this.#heads.count = arrows;
    for (const mesh of [this.#spots, this.#shafts, this.#heads]) mesh.instanceMatrix.needsUpdate = true;
    if (this.#spots.instanceColor) this.#spots.instanceColor.needsUpdate = true;
  }

  #showSpot(element: Element, i: number, row: number, slips: boolean): void {
    const { touchForce, overForce } = this.#columns.finger;
    const compression = this.#columns.compression(row, i);
    const touches = compression > touchForce;
    const over = compression > overForce;
    const colour = over ? pressedTooHard : touches && slips ? slipping : touching;
    this.#spots.setColorAt(i, touches || over ? colour : this.#palette.resting);
    const size = over ? 1.7 : touches ? 1.35 : 1;
    this.#matrix.makeScale(size, size, size).setPosition(pressedTip(element, compression, this.#tip));
    this.#spots.setMatrixAt(i, this.#matrix);
  }

  /** Computes the arrow of an element's force, which starts at the tip; returns `false` if the force is too small. */
  #placeArrow(element: Element, i: number, row: number): boolean {
    const rotation = this.#rotations[i];
    const forces = this.#columns.forces;
    if (!forces || !rotation) return false;
    const at = (k: number) => forces.at(row, 3 * i + k) || 0;
    // Compression acts along the inward normal.
    pressedTip(element, at(2), this.#middle);
    this.#force.set(at(0), at(1), -at(2));
    const newtons = this.#force.length();
    if (newtons < LEAST_FORCE) return false;
    this.#force.divideScalar(newtons).applyQuaternion(rotation);
    this.#turn.setFromUnitVectors(Z, this.#force);
    const length = ARROW_LENGTH * newtons;
    this.#tip.copy(this.#middle).addScaledVector(this.#force, length);
    this.#middle.addScaledVector(this.#force, length / 2);
    this.#scale.set(1, 1, Math.max(length - 2 * this.#size, 1e-6));
    return true;
  }

  #writeArrow(place: number): void {
    this.#matrix.compose(this.#middle, this.#turn, this.#scale);
    this.#shafts.setMatrixAt(place, this.#matrix);
    this.#scale.set(1, 1, 1);
    this.#matrix.compose(this.#tip, this.#turn, this.#scale);
    this.#heads.setMatrixAt(place, this.#matrix);
  }
}

/** Position of a loaded feeler's tip in the finger's frame, written to `out`. */
export function pressedTip({ tip }: Element, compression: number, out: Vector3): Vector3 {
  // The dome's centre is the origin of the frame.
  return out.set(...tip).multiplyScalar(1 - YIELD * Math.max(0, compression));
}

function instances(
  geometry: ConstructorParameters<typeof InstancedMesh>[0],
  material: ConstructorParameters<typeof InstancedMesh>[1],
  count: number,
): InstancedMesh {
  const mesh = new InstancedMesh(geometry, material, count);
  mesh.instanceMatrix.setUsage(DynamicDrawUsage);
  // Culling would recompute the bounds at every row.
  mesh.frustumCulled = false;
  return mesh;
}

/** Radius of the sphere that represents an element (m), scaled with the dome. */
function elementSize(elements: Element[]): number {
  const distances = elements.map(({ tip }) => Math.hypot(...tip));
  return 0.05 * Math.max(1e-4, ...distances);
}
