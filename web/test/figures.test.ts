import assert from "node:assert/strict";
import { test } from "node:test";
import type { Series } from "../src/page_data";
import { plotted, seriesAt } from "../src/figures/columns";
import { decades, equalScale, pinched, placeOn, windowAround } from "../src/figures/plane";
import { commandOf, folderOf, pointAtRow, type Points, pointsOf } from "../src/figures/points";
import { Column, Table } from "../src/table";

const table = new Table(
  [
    new Column("time", 1, Float64Array.of(0, 0.1, 0.2), 1),
    new Column("flags", 1, Uint8Array.of(0, 2, 3), 1),
    new Column("torque", 1, Float32Array.of(0.01, NaN, 0.02), 1),
  ],
  3,
);

const series = (rest: Partial<Series>): Series => ({ name: "s", colour: "shared", line: "solid", ...rest });
const all = (at: (row: number) => number) => [0, 1, 2].map(at);

test("a series shows a column, one bit of it, or separate points", () => {
  assert.deepEqual(all(seriesAt(series({ column: { name: "flags", index: 0 } }), table)), [0, 2, 3]);
  assert.deepEqual(all(seriesAt(series({ column: { name: "flags", index: 0, bit: 1 } }), table)), [0, 1, 1]);
  assert.deepEqual(all(seriesAt(series({ points: { x: [0.19], y: [7] } }), table)), [NaN, NaN, 7]);
  assert.throws(() => seriesAt(series({}), table), /neither/);
  assert.throws(() => seriesAt(series({ column: { name: "gone", index: 0 } }), table), /“gone”/);
});

test("unknown values leave a gap", () => {
  const at = seriesAt(series({ column: { name: "torque", index: 0 } }), table);
  const shown = plotted(at, 3, 1e3);
  assert.deepEqual([Math.round(shown[0] ?? 0), shown[1], Math.round(shown[2] ?? 0)], [10, null, 20]);
});

test("windows contain their points and may have equal scales", () => {
  const window = windowAround(
    [
      [0, 0],
      [10, 5],
      [NaN, 1],
    ],
    0,
  );
  assert.deepEqual(window, { x: [0, 10], y: [0, 5] });
  assert.deepEqual(equalScale(window, 100, 100), { x: [0, 10], y: [-2.5, 7.5] });
});

test("a pinch keeps the values between the fingers", () => {
  const zoomed = pinched({ x: [0, 10], y: [0, 10] }, 100, [40, 60], [30, 70]);
  assert.deepEqual(zoomed, { x: [2.5, 7.5], y: [2.5, 7.5] });
});

test("a row has a point only within the rows of the points", () => {
  const points: Points = {
    series: series({ points: { x: [1, 2, 3], y: [1, 2, 3], row: [10, 20, 30] } }),
    x: [1, 2, 3],
    y: [1, 2, 3],
    low: [],
    high: [],
  };
  assert.equal(pointAtRow(points, 5), undefined);
  assert.equal(pointAtRow(points, 10), 0);
  assert.equal(pointAtRow(points, 25), 1);
  assert.equal(pointAtRow(points, 30), 2);
  assert.equal(pointAtRow(points, 60), undefined);
});

test("logarithmic axes have ticks at 1, 2 and 5 times powers of ten", () => {
  const axis = { label: "false alarms", unit: "%", scale: 100, log: true };
  assert.ok(Math.abs(placeOn(axis, 0.001) + 1) < 1e-12);
  assert.equal(placeOn({ ...axis, log: false }, 0.5), 50);
  const shown = (low: number, high: number) =>
    decades(low, high).map((place) => +(10 ** place).toPrecision(3));
  assert.deepEqual(shown(-2, 2), [0.01, 0.1, 1, 10, 100]);
  assert.deepEqual(shown(Math.log10(0.15), Math.log10(6)), [0.2, 0.5, 1, 2, 5]);
});

test("points have intervals in axis units and a command each", () => {
  const list = {
    x: [1, 2],
    y: [0.5, null],
    low: [0.4, null],
    high: [0.6, null],
    command: { pattern: "feeler run --trial {folder}/best {trial}", trial: [7, 9] },
  };
  const axis = { label: "rate", unit: "%", scale: 100 };
  const points = pointsOf(series({ points: list }), { ...axis, scale: 1 }, axis);
  assert.deepEqual(
    [points.y, points.low, points.high],
    [
      [50, NaN],
      [40, NaN],
      [60, NaN],
    ],
  );
  assert.equal(commandOf(points, 1, "/a/sweep"), "feeler run --trial /a/sweep/best 9");
  assert.equal(commandOf(points, 0, "it's $1 a"), "feeler run --trial 'it'\\''s $1 a/best' 7");
  const plain = pointsOf(series({ points: { x: [1], y: [1] } }), axis, axis);
  assert.deepEqual([commandOf(plain, 0, "."), plain.low], [undefined, []]);
});

test("the folder of a page follows from its address", () => {
  assert.equal(folderOf("file:///home/a%20b/sweep/summary.html?x#fig-01"), "/home/a b/sweep");
  assert.equal(folderOf("file:///C:/sweep/summary.html"), "C:/sweep");
  assert.equal(folderOf("http://127.0.0.1:1/summary.html"), ".");
});
