/** Poses of the scene's frames at a row. */
import { Matrix4, Quaternion, Vector3 } from "three";
import type { Frame, Scene } from "../page_data";
import { PageProblem } from "../problem";
import type { Column, Table } from "../table";

const ROOT = "world";
const UNIT = new Vector3(1, 1, 1);

interface Node {
  /** Parent node; undefined for children of the world. */
  parent: Node | undefined;
  /** Pose in the parent with the joint at zero. */
  rest: Matrix4;
  world: Matrix4;
  joint: { positions: Column; index: number; slides: boolean } | undefined;
  pose: Column | undefined;
}

/** Frame tree. Parents precede their children, so that one pass updates all frames. */
export class FrameTree {
  readonly #nodes: Node[] = [];
  readonly #byName = new Map<string, Node>();
  readonly #motion = new Matrix4();
  readonly #position = new Vector3();
  readonly #rotation = new Quaternion();
  readonly #world = new Matrix4();

  constructor(scene: Scene, table: Table) {
    let waiting = scene.frames;
    while (waiting.length > 0) {
      const ready = waiting.filter((frame) => frame.parent === ROOT || this.#byName.has(frame.parent));
      if (ready.length === 0) {
        throw new PageProblem(`Frame “${waiting[0]?.name}” of the scene has no parent in the world.`);
      }
      for (const frame of ready) this.#add(frame, table);
      waiting = waiting.filter((frame) => !this.#byName.has(frame.name));
    }
  }

  /** Pose of a frame in the world. The returned matrix is updated in place by `moveTo`. */
  world(name: string): Matrix4 {
    const node = this.#byName.get(name);
    if (!node && name !== ROOT) throw new PageProblem(`The scene has no frame “${name}”.`);
    return node?.world ?? this.#world;
  }

  moveTo(row: number): void {
    for (const node of this.#nodes) {
      if (!this.#pose(node, row)) this.#moved(node, row);
      if (node.parent) node.world.premultiply(node.parent.world);
    }
  }

  #add(frame: Frame, table: Table): void {
    const { name, parent, position, rotation, joint } = frame;
    const rest = new Matrix4().compose(new Vector3(...position), new Quaternion(...rotation), UNIT);
    const positions = joint && table.column(`finger/${joint.finger}/joints`);
    const node: Node = {
      parent: this.#byName.get(parent),
      rest,
      world: new Matrix4(),
      joint: positions && { positions, index: joint.joint, slides: joint.prismatic ?? false },
      pose: table.column(`frame/${name}`),
    };
    this.#nodes.push(node);
    this.#byName.set(name, node);
  }

  /** Sets the recorded pose; returns `false` if there is no recorded pose. */
  #pose({ pose, world }: Node, row: number): boolean {
    if (!pose) return false;
    const at = (k: number) => pose.at(row, k);
    this.#position.set(at(0), at(1), at(2));
    this.#rotation.set(at(3), at(4), at(5), at(6)).normalize();
    if (!Number.isFinite(this.#position.lengthSq() + this.#rotation.lengthSq())) return false;
    world.compose(this.#position, this.#rotation, UNIT);
    return true;
  }

  #moved({ rest, world, joint }: Node, row: number): void {
    world.copy(rest);
    const position = joint?.positions.at(row, joint.index) ?? 0;
    if (!Number.isFinite(position)) return;
    if (joint?.slides) world.multiply(this.#motion.makeTranslation(0, 0, position));
    else world.multiply(this.#motion.makeRotationZ(position));
  }
}
