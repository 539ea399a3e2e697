import assert from "node:assert/strict";
import { test } from "node:test";
import { inflate } from "../src/inflate";
import type { RunTable } from "../src/page_data";
import { PageProblem } from "../src/problem";
import { readPage } from "../src/read_page";
import { readTable } from "../src/table";
import { runTable } from "../sample/encode";
import { elements } from "../sample/hand";
import { simulate } from "../sample/simulate";
import { examples } from "./examples";

const run = simulate(1);
const packed = runTable(run, 2, elements().length);
const table = async (from: RunTable = packed) => readTable(from, await inflate(from.data));

test("a table contains the encoded values", async () => {
  const read = await table();
  assert.equal(read.length, run.rows.length);
  const row = 180;
  const forces = run.rows[row]?.forces[1] ?? [];
  forces.forEach((force, k) => {
    const stored = read.column("finger/1/forces")?.at(row, k) ?? NaN;
    assert.ok(Math.abs(stored - force) <= 0.5001e-4, `${stored} for ${force}`);
  });
  assert.equal(read.column("phase")?.at(row), run.rows[row]?.phase);
  assert.equal(read.column("no such column"), undefined);
});

test("rowAt returns the nearest row", async () => {
  const read = await table();
  assert.equal(read.rowAt(-1), 0);
  assert.equal(read.rowAt(1.004), 100);
  assert.equal(read.rowAt(1.006), 101);
  assert.equal(read.rowAt(1e9), run.rows.length - 1);
});

test("unknown values are NaN", () => {
  const columns: RunTable["columns"] = [
    { name: "time", type: "f64", width: 1, scale: 1 },
    { name: "a", type: "i16", width: 1, scale: 0.1 },
  ];
  const bytes = new Uint8Array(20);
  new DataView(bytes.buffer).setInt16(16, -32768, true);
  new DataView(bytes.buffer).setInt16(18, 25, true);
  const read = readTable({ rows: 2, columns, data: "", phases: [], strokes: [] }, bytes);
  assert.ok(Number.isNaN(read.column("a")?.at(0)));
  assert.equal(read.column("a")?.at(1), 2.5);
});

test("damaged data are rejected with a reason", async () => {
  await assert.rejects(inflate(packed.data.slice(0, 1000)), PageProblem);
  await assert.rejects(inflate("no base64!"), PageProblem);
  await assert.rejects(table({ ...packed, rows: packed.rows + 1 }), /truncated/);
  await assert.rejects(table({ ...packed, columns: packed.columns.slice(1) }), /no column “time”/);
  const unknown = [{ name: "time", type: "f16", width: 1, scale: 1 }] as unknown as RunTable["columns"];
  await assert.rejects(table({ ...packed, columns: unknown }), /type “f16”/);
});

test("other versions and invalid pages are rejected with a reason", () => {
  assert.throws(() => readPage("{"), /not valid JSON/);
  assert.throws(() => readPage("null"), /no data/);
  assert.throws(() => readPage('{"version":2}'), /version 2.*version 1/);
  assert.throws(() => readPage('{"version":1}'), /figures/);
  assert.throws(() => readPage('{"version":1,"figures":[],"run":{"columns":[]}}'), /phases/);
  assert.throws(() => readPage('{"version":1,"figures":[],"scene":{}}'), /frames/);
  assert.equal(readPage('{"version":1,"title":"t","figures":[]}').title, "t");
});

test("pages of each kind made by feeler-report are readable", () => {
  for (const example of examples) assert.equal(readPage(JSON.stringify(example)).title, example.title);
  // A report, pages of many trials and a live page together cover all declared fields.
  assert.ok(examples.some((page) => page.scene?.shapes.length && page.run?.strokes.length));
  assert.ok(examples.some((page) => page.live));
  const series = examples.flatMap((page) =>
    page.figures.flatMap((figure) => figure.panels.flatMap((p) => p.series)),
  );
  assert.deepEqual(new Set(series.map(({ line }) => line)), new Set(["solid", "dashed", "points", "states"]));
  for (const field of ["low", "row", "label", "command"] as const) {
    assert.ok(
      series.some(({ points }) => points?.[field]),
      field,
    );
  }
});
