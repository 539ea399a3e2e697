/** Reference hand (crates/feeler-lab/experiments/cap-closing.toml): frames, elements and inverse kinematics. */
import { Matrix4, Quaternion, Vector3 } from "three";
import type { Element, Frame, Quaternion as Four, Shape, Vector } from "../src/page_data";

export const LINKS = [0.03, 0.06, 0.055] as const;
export const DOME_RADIUS = 0.018;
const RINGS = [
  { elements: 1, polar: 0 },
  { elements: 8, polar: 22.5 },
  { elements: 12, polar: 45 },
  { elements: 20, polar: 67.5 },
];

export interface Base {
  position: Vector3;
  /** Rotation about the world's y axis (rad). */
  turn: number;
  /** Bending direction of joint 3. */
  bend: 1 | -1;
}

export const BASES: Base[] = [
  { position: new Vector3(-0.1655, 0, 0.0576), turn: 0, bend: -1 },
  { position: new Vector3(0.1655, 0, 0.0576), turn: Math.PI, bend: 1 },
];

const four = (q: Quaternion): Four => [q.x, q.y, q.z, q.w];
const three = (v: Vector3): Vector => [v.x, v.y, v.z];
const NONE: Four = [0, 0, 0, 1];
/** Joints 2 and 3 rotate about -y of the previous frame. */
const ABOUT_MINUS_Y = four(new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), Math.PI / 2));
/** Rotates z, the axis of a cylinder, to x, the axis of a link. */
const ALONG_X = four(new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), Math.PI / 2));

export function frames(finger: number, base: Base): Frame[] {
  const [l2, l3, l4] = LINKS;
  const name = (part: string) => `finger/${finger}/${part}`;
  const turned = four(new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), base.turn));
  const joint = (joint: number) => ({ joint: { finger, joint } });
  return [
    { name: name("base"), parent: "world", position: three(base.position), rotation: turned },
    { name: name("link1"), parent: name("base"), position: [0, 0, 0], rotation: NONE, ...joint(0) },
    {
      name: name("link2"),
      parent: name("link1"),
      position: [l2, 0, 0],
      rotation: ABOUT_MINUS_Y,
      ...joint(1),
    },
    { name: name("link3"), parent: name("link2"), position: [l3, 0, 0], rotation: NONE, ...joint(2) },
    { name: name("tip"), parent: name("link3"), position: [l4, 0, 0], rotation: NONE },
  ];
}

export function shapes(finger: number): Shape[] {
  const [l2, l3, l4] = LINKS;
  const name = (part: string) => `finger/${finger}/${part}`;
  const link = (frame: string, length: number, radius: number): Shape[] => [
    {
      frame,
      position: [length / 2, 0, 0],
      rotation: ALONG_X,
      role: "link",
      solid: { kind: "cylinder", radius, length },
    },
    {
      frame,
      position: [0, 0, 0],
      rotation: NONE,
      role: "link",
      solid: { kind: "sphere", radius: 1.35 * radius },
    },
  ];
  return [
    {
      frame: name("base"),
      position: [0, 0, -0.02],
      rotation: NONE,
      role: "link",
      solid: { kind: "box", size: [0.03, 0.03, 0.02] },
    },
    ...link(name("link1"), l2, 0.007),
    ...link(name("link2"), l3, 0.006),
    ...link(name("link3"), l4 - 0.006, 0.0055),
    {
      frame: name("tip"),
      position: [0, 0, 0],
      rotation: NONE,
      role: "dome",
      solid: { kind: "sphere", radius: DOME_RADIUS },
    },
  ];
}

export function elements(): Element[] {
  return RINGS.flatMap(({ elements, polar }) =>
    Array.from({ length: elements }, (_, j) => {
      const [p, a] = [(polar * Math.PI) / 180, (2 * Math.PI * j) / elements];
      const normal = new Vector3(Math.cos(p), Math.sin(p) * Math.cos(a), Math.sin(p) * Math.sin(a));
      const meridian = new Vector3(-Math.sin(p), Math.cos(p) * Math.cos(a), Math.cos(p) * Math.sin(a));
      const basis = new Matrix4().makeBasis(meridian, normal.clone().cross(meridian), normal);
      const rotation = four(new Quaternion().setFromRotationMatrix(basis));
      return { tip: three(normal.clone().multiplyScalar(DOME_RADIUS)), rotation };
    }),
  );
}

/** Joint angles that place the dome's centre at `point`. */
export function jointsAt({ position, turn, bend }: Base, point: Vector3): [number, number, number] {
  const [l2, l3, l4] = LINKS;
  const inBase = point
    .clone()
    .sub(position)
    .applyAxisAngle(new Vector3(0, 1, 0), -turn);
  const radius = Math.hypot(inBase.x, inBase.y) - l2;
  const cosine = (radius ** 2 + inBase.z ** 2 - l3 ** 2 - l4 ** 2) / (2 * l3 * l4);
  const theta3 = bend * Math.acos(Math.min(1, Math.max(-1, cosine)));
  const theta2 = Math.atan2(inBase.z, radius) - Math.atan2(l4 * Math.sin(theta3), l3 + l4 * Math.cos(theta3));
  return [Math.atan2(inBase.y, inBase.x), theta2, theta3];
}

/** Pose of the fingertip in the world at these joint angles. */
export function tipPose({ position, turn }: Base, [t1, t2, t3]: [number, number, number]): Matrix4 {
  const [l2, l3, l4] = LINKS;
  const step = (x: number, turned: Matrix4) => new Matrix4().makeTranslation(x, 0, 0).multiply(turned);
  return new Matrix4()
    .makeTranslation(position)
    .multiply(new Matrix4().makeRotationY(turn))
    .multiply(new Matrix4().makeRotationZ(t1))
    .multiply(step(l2, new Matrix4().makeRotationX(Math.PI / 2).multiply(new Matrix4().makeRotationZ(t2))))
    .multiply(step(l3, new Matrix4().makeRotationZ(t3)))
    .multiply(step(l4, new Matrix4()));
}
