import assert from "node:assert/strict";
import { test } from "node:test";
import { feel, type Feeling, freshness, HOLD, SILENT, strongest, type Touch } from "../src/feel/mapping";
import { readSettings } from "../src/feel/settings";

const touch = (force: number, slip = false, shearRate = 0): Touch => ({
  force,
  touch: true,
  slip,
  shearRate,
});
const rounded = ({ strong, weak, frequency, gain }: Feeling) =>
  [strong, weak, frequency, gain].map((value) => Number(value.toFixed(4)));

test("grip and slip map to rumble and tone", () => {
  // Computed by hand: 150 Hz · 2^grip, four times that during slip; gain 0.3 · max(grip, slip).
  assert.deepEqual(rounded(feel(touch(0), 2, 0)), [0, 0, 150, 0]);
  assert.deepEqual(rounded(feel(touch(1), 2, 0)), [0.5, 0, 212.132, 0.15]);
  assert.deepEqual(rounded(feel(touch(2), 2, 0)), [1, 0, 300, 0.3]);
  assert.deepEqual(rounded(feel(touch(9), 2, 0)), [1, 0, 300, 0.3]);
  assert.deepEqual(rounded(feel(touch(1, true, 10), 2, 0)), [0.5, 0.75, 848.5281, 0.225]);
  assert.deepEqual(rounded(feel(touch(0, true, 1e6), 2, 0)), [0, 1, 600, 0.3]);
  assert.deepEqual(rounded(feel({ ...touch(1), touch: false }, 2, 0)), [0, 0, 150, 0]);
});

test("everything stays within its range for any data", () => {
  const odd = [NaN, -Infinity, -1, -0, 0, 1e-320, 0.5, 3, 1e300, Infinity];
  for (const force of odd)
    for (const shearRate of odd)
      for (const full of odd)
        for (const age of odd) {
          const { strong, weak, frequency, gain } = feel(touch(force, true, shearRate), full, age);
          for (const share of [strong, weak]) assert.ok(share >= 0 && share <= 1, `${share}`);
          assert.ok(gain >= 0 && gain <= 0.3 && frequency >= 150 && frequency <= 1200);
        }
});

test("stale data fade to nothing within 100 ms", () => {
  assert.ok(SILENT < 100);
  const clock = Array.from({ length: 1000 }, (_, ms) => ms);
  let before = 1;
  for (const age of clock) {
    const { strong, weak, gain } = feel(touch(5, true, 50), 2, age);
    assert.ok(strong <= before, `rises at ${age} ms`);
    before = strong;
    if (age <= HOLD) assert.deepEqual([strong, weak, gain], [1, 1, 0.3]);
    if (age >= 100) assert.deepEqual([strong, weak, gain], [0, 0, 0]);
  }
  assert.equal(freshness((HOLD + SILENT) / 2), 0.5);
  assert.equal(freshness(NaN), 0);
});

test("the strongest finger is felt", () => {
  const [weak, strong] = [feel(touch(0.5), 2, 0), feel(touch(0.1, true, 10), 2, 0)];
  assert.equal(strongest([weak, strong]), strong);
  assert.equal(strongest([strong, weak]), strong);
  assert.deepEqual(rounded(strongest([])), [0, 0, 150, 0]);
});

test("remembered settings are checked", () => {
  const off = { on: false, finger: undefined, fullForce: 2 };
  for (const odd of [null, "", "{", "null", "7", "[]", '"on"', '{"on":1,"finger":2,"fullForce":3}'])
    assert.deepEqual(readSettings(odd, 2), off, `${odd}`);
  for (const finger of ["-1", "0.5", "1e99", '"0"', "null"])
    assert.deepEqual(readSettings(`{"finger":${finger}}`, 2), off, finger);
  const chosen = { on: true, finger: 1, fullForce: 10 };
  assert.deepEqual(readSettings(JSON.stringify(chosen), 2), chosen);
});
