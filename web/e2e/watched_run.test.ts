/** A run of the program, watched and commanded in the browser from start to end. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import type { Browser, Page } from "playwright-core";
import { FLAG_NAMES } from "../src/run";
import { holdLatency, launch, open, until } from "./browser";
import { Program, ask, folder, killAll, skip } from "./feeler";
import { type Change, type Noted, note, noted } from "./noted";
import { type Recorded, begins, recorded } from "./recorded";

/**
 * Number of stops, minimum duration of a stop, and time between stops (ms); short enough that a slow browser finishes
 * before the run.
 */
const STOPS = 4;
const STANDS = 500;
const WORKS = 300;
/** Rows of 10 ms within which the drives come to rest. */
const SETTLES = 20;

describe("a run in the browser", { skip }, () => {
  const where = folder();
  let browser: Browser;
  let program: Program;
  let page: Page;
  let errors: string[];
  let shown: Noted;
  let record: Recorded;

  before(async () => {
    browser = await launch();
    // In real time.
    program = new Program(where, [
      "run",
      "cap-closing",
      "--sensing=direct",
      "--out=run",
      "--view",
      "--no-open",
    ]);
    // A small page, because there may be no graphics card.
    const viewport = { width: 640, height: 480 };
    ({ page, errors } = await open(browser, await program.url(), { viewport }, note));
  });
  after(async () => {
    killAll();
    await browser.close();
  });

  const time = async () => Number.parseFloat(await page.locator(".player-time").innerText());
  const stop = () => page.getByRole("button", { name: "Stop the hand" });
  const resume = () => page.getByRole("button", { name: "Resume the hand" });

  test("rows arrive, and the scene moves", async () => {
    await until(async () => (await time()) > 0, "a row is shown");
    const before = await time();
    const canvas = page.locator(".scene-canvas canvas");
    const picture = await canvas.screenshot();
    await until(async () => (await time()) > before + 0.5, "later rows are shown");
    assert.ok(!picture.equals(await canvas.screenshot()));
  });

  test("stop and resume are acknowledged", async () => {
    for (let i = 0; i < STOPS; i++) {
      await stop().click();
      await page.getByText("The hand is stopped: stop requested by the live page.").waitFor();
      await page.getByText("Stop: the hand is stopped.").waitFor();
      await page.waitForTimeout(STANDS);
      await resume().click();
      await page.getByText("Resume: the hand has resumed.").waitFor();
      await page.waitForTimeout(WORKS);
    }
  });

  test("the end is reported, and the page shows no warning", async () => {
    await page.getByText("The task is done. No further data.").waitFor();
    assert.equal(await program.ended, 0, program.said);
    assert.equal(await page.locator(".live-notice").isVisible(), false);
    assert.deepEqual(errors, []);
    shown = await noted(page);
  });

  test("the report of the recording opens and offers it for download", async () => {
    const view = new Program(where, ["view", "run", "--no-open"]);
    const url = await view.url();
    record = await recorded((await ask(url, {})).body);
    const { page: report, errors } = await open(browser, url);
    await report.locator(".uplot").first().waitFor();
    const loading = report.waitForEvent("download");
    await report.getByRole("link", { name: "recording.mcap" }).click();
    const loaded = await loading;
    assert.equal(loaded.suggestedFilename(), "recording.mcap");
    assert.ok(readFileSync(await loaded.path()).equals(readFileSync(join(where, "run/recording.mcap"))));
    assert.deepEqual(errors, []);
    assert.equal(await view.interrupt(), 0);
  });

  test("each press of the button stopped the hand, which stood still", () => {
    const { table, run } = record;
    assert.equal(shown.stops.length, STOPS);
    assert.equal(begins(record, "STOPPED").length, STOPS);
    for (const finger of [0, 1]) {
      const joints = table.column(`finger/${finger}/joints`);
      assert.ok(joints);
      const angles = (row: number) => [0, 1, 2].map((joint) => joints.at(row, joint));
      let stood = 0;
      for (let row = SETTLES; row < table.length; row++) {
        if (run.phase(row) !== "STOPPED" || run.phase(row - SETTLES) !== "STOPPED") continue;
        assert.deepEqual(angles(row), angles(row - 1), `${table.time(row)} s`);
        stood++;
      }
      assert.ok(stood >= STOPS * SETTLES, `${stood} rows`);
    }
  });

  test("the page showed the recorded flags at every received row", () => {
    assert.ok(shown.rows.length > 100);
    const changes = [...shown.changes];
    const on = new Set<string>();
    for (const { time } of shown.rows) {
      while (changes[0]?.row.time === time) {
        const { finger, name, on: isOn } = changes.shift()!;
        on[isOn ? "add" : "delete"](`${finger} ${name}`);
      }
      const row = record.table.rowAt(time);
      assert.equal(record.table.time(row), time);
      const flags = record.fingers.flatMap((finger) =>
        FLAG_NAMES.filter(([bit]) => finger.flags(row) & bit).map(([, name]) => `${finger.number} ${name}`),
      );
      assert.deepEqual([...on].sort(), flags.sort(), `${time} s`);
    }
    assert.deepEqual(changes, []);
    // Two fingers touch and release in each of four strokes.
    assert.ok(shown.changes.filter(({ name }) => name === "TOUCH").length >= 16);
  });

  /** Time of the step in which a flag changed (s); may be before the row that shows the change. */
  const began = ({ row: { time }, finger, name, on }: Change) => {
    const bit = FLAG_NAMES.find(([, flag]) => flag === name)?.[0] ?? 0;
    const isSo = (row: number) => (((record.fingers[finger]?.flags(row) ?? 0) & bit) !== 0) === on;
    let row = record.table.rowAt(time);
    while (row > 0 && isSo(row - 1)) row--;
    return record.table.time(row);
  };

  /**
   * Latency from the step in which a flag changes to the chip that shows it. It has three parts:
   *
   * 1. from the step of the change to the step whose row shows it, according to the recording;
   * 2. from that step to the arrival of its row on the page;
   * 3. from the arrival to the change of the chip.
   *
   * Part 2 cannot be measured from outside the program. Its upper bound is the time from a press of the stop button to
   * the arrival of the first row of the stopped hand, minus the recorded time between the stopped step and that row.
   * It includes the transfer of the order. The test uses the lower quartile of this bound, because a busy computer may
   * delay any message, and the median of the sum of parts 1 and 3.
   */
  test("latency of flags", () => {
    const stopped = begins(record, "STOPPED");
    const ways = shown.stops.map((pressed, i) => {
      const stop = stopped[i] ?? NaN;
      const row = shown.rows.find(({ time }) => time >= stop);
      return row ? row.at - pressed - 1000 * (row.time - stop) : NaN;
    });
    const way = quantile(ways, 0.25);
    // Only TOUCH: SLIP may change in every step, so the step that a row shows is ambiguous.
    const touches = shown.changes.filter(({ name }) => name === "TOUCH");
    const rest = quantile(
      touches.map((change) => 1000 * (change.row.time - began(change)) + change.at - change.row.at),
      0.5,
    );
    assert.ok(rest + way > 0, `${rest} ms, and ${ways.join(", ")} ms`);
    const parts = `${way.toFixed(0)} ms of it for the transfer of an order and a row`;
    holdLatency(`flags after ${(rest + way).toFixed(0)} ms, ${parts}`, rest + way);
  });
});

/** Quantile of the numbers; NaN if any of them is NaN. */
function quantile(numbers: number[], share: number): number {
  const sorted = numbers.toSorted((a, b) => a - b);
  return numbers.some(Number.isNaN) ? NaN : (sorted[Math.floor(share * sorted.length)] ?? NaN);
}
