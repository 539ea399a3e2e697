/** The live page, connected to a simulated rig. */
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import type { Browser, Page } from "playwright-core";
import { holdLatency, launch, open, until } from "./browser";
import { type Rig, startRig } from "./live_server";

let browser: Browser;
let rig: Rig;
let page: Page;
let errors: string[];

before(async () => {
  browser = await launch();
  rig = await startRig();
  ({ page, errors } = await open(browser, rig.url));
  await until(async () => rig.sockets() === 1, "the page connects");
});
after(async () => {
  await browser.close();
  await rig.close();
});

const chip = (finger: number, name: string) =>
  page.locator(".live-finger").nth(finger).locator(`.chip.${name}.on`);

/** Records the times at which the TOUCH chip of the first finger changes. Returns a function that reads them (ms). */
async function watchTouch(): Promise<() => Promise<number[]>> {
  await page.evaluate(() => {
    const times: number[] = ((window as unknown as { times: number[] }).times = []);
    const chip = document.querySelector(".live-finger .chip.TOUCH") as Element;
    let on = chip.classList.contains("on");
    new MutationObserver(() => {
      if (chip.classList.contains("on") !== on) times.push(Date.now());
      on = chip.classList.contains("on");
    }).observe(chip, { attributes: true });
  });
  return () => page.evaluate(() => (window as unknown as { times: number[] }).times);
}

test("flags are shown immediately", async () => {
  const row = rig.rows.find((row) => row.flags.every((flags) => flags & 1));
  assert.ok(row);
  const changes = await watchTouch();
  const took: number[] = [];
  for (let i = 0; i < 12; i++) {
    const sent = Date.now();
    rig.send({ ...row, time: i * 0.01, flags: i % 2 === 0 ? [1, 1] : [0, 0] });
    await until(async () => (await changes()).length > i, `change ${i}`);
    took.push(((await changes())[i] ?? NaN) - sent);
  }
  assert.equal(await chip(1, "TOUCH").count(), 0);
  // The median, because other programs may delay single changes.
  const middle = took.sort((a, b) => a - b)[6] ?? NaN;
  holdLatency(`flags after ${middle} ms`, middle);
});

test("the latest row is shown", async () => {
  const canvas = page.locator(".scene-canvas canvas");
  const before = await canvas.screenshot();
  for (const row of rig.rows.slice(100, 700)) rig.send(row);
  const newest = rig.rows[699]?.time.toFixed(2) ?? "";
  await until(async () => (await page.locator(".player-time").innerText()).startsWith(newest), newest);
  assert.ok(!before.equals(await canvas.screenshot()));
});

test("the state is shown, and stop and resume are sent", async () => {
  rig.state({ state: "MOVE of stroke 1", stopped: false, over: false });
  await page.getByText("MOVE of stroke 1").waitFor();
  await page.getByRole("button", { name: "Stop the hand" }).focus();
  await page.keyboard.press("Enter");
  await until(async () => rig.orders.length === 1, "the order arrives");
  assert.deepEqual(JSON.parse(rig.orders[0] ?? ""), { order: "stop" });
  rig.state({ state: "Stopped by request.", stopped: true, answer: "All drives are at rest.", over: false });
  await page.getByText("All drives are at rest.").waitFor();
  await page.getByRole("button", { name: "Resume the hand" }).click();
  await until(async () => rig.orders.length === 2, "the order arrives");
  assert.deepEqual(JSON.parse(rig.orders[1] ?? ""), { order: "resume" });
});

test("stale data are reported", async () => {
  await page.getByText(/No data for \d+ s/).waitFor({ timeout: 5000 });
});

test("a lost connection is reported and reopened", async () => {
  rig.cut();
  await page.getByText(/Connection lost/).waitFor();
  await until(async () => rig.sockets() === 1, "the page reconnects");
  rig.send(rig.rows[720] ?? rig.rows[0]!);
  await until(async () => !(await page.locator(".live-notice").isVisible()), "the notice disappears");
});

test("an unreadable message is reported and otherwise ignored", async () => {
  rig.state({} as never);
  await page.getByText(/a state that this page cannot read/).waitFor();
  rig.state({ state: "RELEASE of stroke 1", stopped: false, over: false });
  await page.getByText("RELEASE of stroke 1").waitFor();
});

test("the end of the run is shown, and the page does not reconnect", async () => {
  rig.state({ state: "Done.", stopped: false, over: true });
  await page.getByText("No further data.").waitFor();
  rig.cut();
  await page.waitForTimeout(800);
  assert.equal(rig.sockets(), 0);
  assert.equal(await page.locator(".live-notice").isVisible(), false);
  assert.deepEqual(errors, []);
});
