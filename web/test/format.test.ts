import assert from "node:assert/strict";
import { test } from "node:test";
import { moment, quantity, significant, tick } from "../src/format";

test("numbers have three significant digits, as in feeler-report", () => {
  assert.equal(significant(0), "0");
  assert.equal(significant(4), "4");
  assert.equal(significant(0.02934), "0.0293");
  assert.equal(significant(-12.345), "\u221212.3");
  assert.equal(significant(48.76), "48.8");
  assert.equal(significant(123456), "123456");
  assert.equal(significant(-1e-13), "0");
  assert.equal(significant(0.15), "0.15");
  assert.equal(significant(NaN), "–");
  assert.equal(significant(-Infinity), "\u2212∞");
});

test("quantities have a unit; unknown quantities are a dash", () => {
  assert.equal(quantity(0.01234, "mN·m", 1e3), "12.3\u00a0mN·m");
  assert.equal(quantity(0.5, ""), "0.5");
  assert.equal(quantity(NaN, "N"), "–");
});

test("times distinguish rows 10 ms apart", () => {
  assert.equal(moment(12.34), "12.34\u00a0s");
  assert.equal(moment(-0.001), "0.00\u00a0s");
  assert.equal(moment(NaN), "–");
});

test("ticks have as many decimals as their step", () => {
  assert.deepEqual(
    [0, 2.5, 5].map((value) => tick(value, 2.5)),
    ["0.0", "2.5", "5.0"],
  );
  assert.equal(tick(-20, 10), "\u221220");
  assert.equal(tick(0.15, 0.05), "0.15");
  assert.equal(tick(0.30000000000000004, 0.1), "0.3");
});
