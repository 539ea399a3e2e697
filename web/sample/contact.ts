/** Contact of a fingertip's feelers with a cap: normal and tangential springs, and friction. */
import { Matrix4, Quaternion, Vector3 } from "three";
import type { Element } from "../src/page_data";

export const CAP = { radius: 0.014, height: 0.02 };
const TIP_RADIUS = 0.0021;
const NORMAL_STIFFNESS = 170;
const SHEAR_STIFFNESS = 90;
const [STATIC, KINETIC] = [0.9, 0.62];

export interface Felt {
  /** x, y, z of each element (N). */
  forces: number[];
  slips: boolean;
  /** Torque on the cap about its axis (N m). */
  torque: number;
}

/** Contact state of a fingertip. Shear depends on the previous steps. */
export class Contact {
  readonly #elements: { tip: Vector3; rotation: Quaternion; shear: Vector3; last: Vector3 | undefined }[];

  constructor(elements: Element[]) {
    this.#elements = elements.map(({ tip, rotation }) => ({
      tip: new Vector3(...tip),
      rotation: new Quaternion(...rotation),
      shear: new Vector3(),
      last: undefined,
    }));
  }

  /**
   * Advances the fingertip to `pose`. The cap, whose axis is the world's z, has turned by `turned` since the last step.
   */
  step(pose: Matrix4, capHeight: number, turned: number): Felt {
    const felt: Felt = { forces: [], slips: false, torque: 0 };
    const turn = new Quaternion().setFromRotationMatrix(pose);
    for (const element of this.#elements) {
      const tip = element.tip.clone().applyMatrix4(pose);
      const outward = new Vector3(tip.x, tip.y, 0);
      const distance = outward.length();
      outward.normalize();
      const toWorld = turn.clone().multiply(element.rotation);
      const facing = -new Vector3(0, 0, 1).applyQuaternion(toWorld).dot(outward);
      const inside = CAP.radius + TIP_RADIUS - distance;
      const beside = Math.abs(tip.z - capHeight) < CAP.height / 2 + TIP_RADIUS;
      const compression = beside && facing > 0 ? NORMAL_STIFFNESS * Math.max(0, inside) * facing : 0;
      if (compression === 0) {
        element.last = undefined;
        element.shear.set(0, 0, 0);
        felt.forces.push(0, 0, 0);
        continue;
      }
      felt.slips = this.#shear(element, tip, outward, compression, turned) || felt.slips;
      const force = element.shear.clone().multiplyScalar(-SHEAR_STIFFNESS);
      felt.torque -= tip.x * force.y - tip.y * force.x;
      const inElement = force.applyQuaternion(toWorld.invert());
      felt.forces.push(inElement.x, inElement.y, compression);
    }
    return felt;
  }

  /**
   * Updates the shear of an element by its displacement on the cap, limited by friction; returns `true` if it slips.
   */
  #shear(
    element: { shear: Vector3; last: Vector3 | undefined },
    tip: Vector3,
    outward: Vector3,
    compression: number,
    turned: number,
  ): boolean {
    const held = element.last?.applyAxisAngle(new Vector3(0, 0, 1), turned) ?? tip;
    element.shear.add(tip).sub(held);
    element.shear.addScaledVector(outward, -element.shear.dot(outward));
    element.last = tip.clone();
    const stretched = SHEAR_STIFFNESS * element.shear.length();
    if (stretched <= STATIC * compression) return false;
    element.shear.multiplyScalar((KINETIC * compression) / stretched);
    return true;
  }
}
