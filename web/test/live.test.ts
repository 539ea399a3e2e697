import assert from "node:assert/strict";
import { test } from "node:test";
import { readState } from "../src/live/messages";
import { Ring } from "../src/live/ring";
import { columns, rowMessage } from "../sample/encode";
import { elements } from "../sample/hand";
import { simulate } from "../sample/simulate";

const { rows } = simulate(1);
const written = columns(2, elements().length);

test("a ring keeps the latest rows in constant memory", () => {
  const ring = new Ring(written, 50);
  let gone = 0;
  for (const row of rows) gone += ring.add(rowMessage(row, written));
  const { table } = ring;
  assert.equal(table.length + gone, rows.length);
  assert.ok(table.length >= 50 && table.length <= 100);
  const last = rows.at(-1);
  assert.equal(table.time(table.length - 1), last?.time);
  assert.equal(table.rowAt(last?.time ?? 0), table.length - 1);
  const angle = table.column("cap_angle")?.at(table.length - 1) ?? NaN;
  assert.ok(Math.abs(angle - (last?.capAngle ?? 0)) < 1e-6);
});

test("time that decreases starts a new run", () => {
  const ring = new Ring(written, 50);
  const [first, second] = rows;
  assert.ok(first && second);
  ring.add(rowMessage(first, written));
  ring.add(rowMessage(second, written));
  assert.equal(ring.add(rowMessage(first, written)), 2);
  assert.equal(ring.table.length, 1);
});

test("unreadable messages are rejected with a reason", () => {
  assert.throws(() => new Ring(written, 50).add(new ArrayBuffer(12)), /12 bytes/);
  assert.throws(() => readState("{"), /not valid JSON/);
  assert.throws(() => readState("null"), /cannot read/);
  assert.throws(() => readState('{"state":1}'), /cannot read/);
  const state = { state: "MOVE of stroke 2", stopped: false, over: false };
  assert.deepEqual(readState(JSON.stringify(state)), state);
});
