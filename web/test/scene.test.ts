import assert from "node:assert/strict";
import { test } from "node:test";
import { Vector3 } from "three";
import { inflate } from "../src/inflate";
import { readTable } from "../src/table";
import { FrameTree } from "../src/scene/frames";
import { camera, spots } from "../src/fingertip/optics";
import { scene } from "../sample/page_data";
import { runTable } from "../sample/encode";
import { BASES, elements, jointsAt, tipPose } from "../sample/hand";
import { simulate } from "../sample/simulate";

test("frames moved by joints agree with the finger's kinematics", async () => {
  const run = simulate(1);
  const packed = runTable(run, 2, elements().length);
  const frames = new FrameTree(scene(), readTable(packed, await inflate(packed.data)));
  const row = 200;
  frames.moveTo(row);
  BASES.forEach((base, finger) => {
    const [a = 0, b = 0, c = 0] = run.rows[row]?.joints[finger] ?? [];
    const expected = new Vector3().setFromMatrixPosition(tipPose(base, [a, b, c]));
    const got = new Vector3().setFromMatrixPosition(frames.world(`finger/${finger}/tip`));
    // Joints are recorded as f32.
    assert.ok(got.distanceTo(expected) < 1e-6, `${got.toArray()} for ${expected.toArray()}`);
  });
});

test("a prismatic joint moves its frame along z", async () => {
  const run = simulate(1);
  const packed = runTable(run, 2, elements().length);
  const slide = { finger: 0, joint: 1, prismatic: true };
  const frames = [
    {
      name: "rail",
      parent: "world",
      position: [1, 2, 3],
      rotation: [0, Math.SQRT1_2, 0, Math.SQRT1_2],
      joint: slide,
    },
  ];
  const tree = new FrameTree({ ...scene(), frames } as never, readTable(packed, await inflate(packed.data)));
  tree.moveTo(200);
  // The frame's z axis is x of the world.
  const expected = new Vector3(1 + (run.rows[200]?.joints[0]?.[1] ?? 0), 2, 3);
  const got = new Vector3().setFromMatrixPosition(tree.world("rail"));
  assert.ok(got.distanceTo(expected) < 1e-6, `${got.toArray()} for ${expected.toArray()}`);
});

test("a frame with a recorded pose has that pose", async () => {
  const run = simulate(1);
  const packed = runTable(run, 2, elements().length);
  const frames = new FrameTree(scene(), readTable(packed, await inflate(packed.data)));
  const row = run.rows.length - 1;
  frames.moveTo(row);
  const mark = new Vector3(1, 0, 0).transformDirection(frames.world("cap"));
  assert.ok(Math.abs(Math.atan2(mark.y, mark.x) - (run.rows[row]?.capAngle ?? 0)) < 1e-6);
});

test("frames without a connection to the world are rejected", () => {
  const loop = {
    ...scene(),
    frames: [{ name: "a", parent: "a", position: [0, 0, 0], rotation: [0, 0, 0, 1] }],
  };
  const packed = {
    rows: 0,
    columns: [{ name: "time", type: "f64", width: 1, scale: 1 }],
    data: "",
    phases: [],
  };
  const table = readTable({ ...packed, strokes: [] } as never, new Uint8Array());
  assert.throws(() => new FrameTree(loop as never, table), /“a” of the scene has no parent/);
});

test("inverse kinematics reaches the points of the task", () => {
  const point = new Vector3(-0.038, 0.00195, 0.1);
  const [base] = BASES;
  assert.ok(base);
  const reached = new Vector3().setFromMatrixPosition(tipPose(base, jointsAt(base, point)));
  assert.ok(reached.distanceTo(point) < 1e-12);
});

test("the camera view shows the dome from inside: apex in the middle, z up, y to the left", () => {
  const seen = spots(elements());
  assert.deepEqual(
    [seen[0]?.x, seen[0]?.y].map((value) => Math.abs(value ?? 1)),
    [0, 0],
  );
  // The first element of a ring is towards y, the element a quarter turn later towards z.
  assert.ok((seen[1]?.x ?? 0) < -0.1 && Math.abs(seen[1]?.y ?? 1) < 1e-9);
  assert.ok((seen[3]?.y ?? 0) > 0.1 && Math.abs(seen[3]?.x ?? 1) < 1e-9);
  assert.ok(seen.every(({ x, y }) => Math.hypot(x, y) < 1));
});

test("the camera sees each tip at its spot", () => {
  const seen = camera(elements());
  for (const [i, { x, y }] of spots(elements()).entries()) {
    assert.deepEqual(seen(elements()[i]?.tip ?? [0, 0, 0]), [x, y]);
  }
});
