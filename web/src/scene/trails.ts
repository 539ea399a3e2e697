/** Trail of a finger's touching tips, drawn as dots in the world. */
import { BufferAttribute, BufferGeometry, Points, PointsMaterial, Vector3 } from "three";
import type { FingerColumns, Run } from "../run";
import { pressedTip } from "./elements";
import type { FrameTree } from "./frames";

/** Duration of a trail outside of strokes (s). */
const SECONDS = 3;

export class Trail {
  readonly points: Points<BufferGeometry, PointsMaterial>;
  readonly #columns: FingerColumns;
  readonly #run: Run;
  #positions = new BufferAttribute(new Float32Array(3 * 1024), 3);
  /** For each row, the number of dots before it. */
  #before: number[] = [0];
  #dots = 0;
  readonly #dot = new Vector3();

  constructor(columns: FingerColumns, run: Run) {
    this.#columns = columns;
    this.#run = run;
    const material = new PointsMaterial({
      size: 3,
      sizeAttenuation: false,
      depthTest: false,
      transparent: true,
    });
    const geometry = new BufferGeometry().setAttribute("position", this.#positions);
    this.points = new Points(geometry, material);
    this.points.frustumCulled = false;
  }

  /** Number of rows in the trail. */
  get rows(): number {
    return this.#before.length - 1;
  }

  /** Removes all rows. */
  clear(): void {
    this.#before.length = 1;
    this.#dots = 0;
  }

  /** Adds the next row, to which `frames` has been moved. */
  add(frames: FrameTree): void {
    const row = this.rows;
    const { elements, frame, touchForce } = this.#columns.finger;
    const world = frames.world(frame);
    for (let i = 0; i < elements.length; i++) {
      const element = elements[i];
      const compression = this.#columns.compression(row, i);
      if (!element || compression <= touchForce) continue;
      pressedTip(element, compression, this.#dot).applyMatrix4(world);
      this.#push();
    }
    this.#before.push(this.#dots);
  }

  show(row: number): void {
    const { table } = this.#run;
    const stroke = this.#run.stroke(row);
    const start = stroke ? stroke.start : table.rowAt(table.time(row) - SECONDS);
    const first = this.#before[start] ?? 0;
    const end = this.#before[Math.min(row + 1, this.rows)] ?? 0;
    this.points.geometry.setDrawRange(first, Math.max(0, end - first));
  }

  #push(): void {
    const room = this.#positions.count;
    if (this.#dots >= room) {
      const larger = new Float32Array(6 * room);
      larger.set(this.#positions.array);
      this.#positions = new BufferAttribute(larger, 3);
      // Disposing the geometry also frees the old buffer on the graphics card.
      this.points.geometry.dispose();
      this.points.geometry.setAttribute("position", this.#positions);
    }
    const { x, y, z } = this.#dot;
    this.#positions.setXYZ(this.#dots++, x, y, z);
    this.#positions.needsUpdate = true;
  }
}
