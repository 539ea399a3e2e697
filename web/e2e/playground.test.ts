/** The playground: the same results as the program, without a network. `PLAYGROUND` is the page, `FEELER` the program. */
import assert from "node:assert/strict";
import { readFileSync, statSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import type { Browser } from "playwright-core";
import { eventually, launch, type Opened, until } from "./browser";
import * as playground from "./playground_page";
import { folder, nothingElse, page as file, program, skip } from "./playground_page";

const LARGEST = 4e6;

let browser: Browser;
before(async () => {
  if (!skip) browser = await launch();
});
after(async () => {
  if (!skip) await browser.close();
});

const opened = (hash = "", options = {}): Promise<Opened> => playground.opened(browser, hash, options);

test("a run is shown, reported, and can be repeated from its link and its command", { skip }, async () => {
  const result = await opened(
    "#experiment=cap-closing&seed=3&sensing=direct&set=sim.feeler.static_friction%3D0.9",
  );
  const { page } = result;
  await page.selectOption("#speed", "Infinity");
  await page.click("button.primary");
  const digest = page.locator(".result .digest");
  await digest.waitFor();
  assert.match((await digest.textContent()) ?? "", /^[0-9a-f]{64}$/);
  await page.getByText("Complete report with all figures").click();
  const report = page.frameLocator("iframe.report");
  await report.getByRole("heading", { name: "cap-closing" }).first().waitFor();
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("button", { name: "Download report.html" }).click(),
  ]);
  assert.match(readFileSync(await download.path(), "utf8"), /<h1>.*cap-closing/);
  const settings = {
    experiment: "cap-closing",
    seed: 3,
    sensing: "direct",
    set: ["sim.feeler.static_friction=0.9"],
  } as const;
  const again = await page.evaluate(
    async (all) => (await window.feeler.run({ ...all, set: [...all.set] })).digest,
    settings,
  );
  assert.equal(await digest.textContent(), again);
  assert.match(page.url(), /seed=3.*static_friction%3D0\.9/);
  nothingElse(result);
});

test("two laws are compared on the same hand", { skip }, async () => {
  const result = await opened("#experiment=cap-closing&seed=0&sensing=direct&compare=open-loop");
  await result.page.selectOption("#speed", "Infinity");
  await result.page.click("button.primary");
  await eventually(() => result.page.locator(".result .digest").count(), 2, "two results");
  const [first, second] = await result.page.locator(".result .digest").allTextContents();
  assert.notEqual(first, second);
  nothingElse(result);
});

test("a paused run advances by single steps, and friction changes it while it runs", { skip }, async () => {
  const { page } = await opened("#experiment=cap-closing&seed=0&sensing=direct");
  await page.click("button.primary");
  await page.getByRole("button", { name: "Pause or continue" }).click();
  await until(async () => (await page.locator(".player-time").textContent()) !== "no data yet", "a row");
  const time = () => page.locator(".player-time").textContent();
  await page.waitForTimeout(300);
  const before = await time();
  await page.getByRole("button", { name: "one control step" }).click();
  await until(async () => (await time()) !== before, "a step");
  await page.locator("#slider-friction").fill("0.5");
  await page.getByRole("button", { name: "End the run" }).click();
  await page.getByText("You changed the run at").waitFor();
});

test("a slider that moves during a run computes it again up to the present time", { skip }, async () => {
  const result = await opened("#experiment=cap-closing&seed=0&sensing=direct");
  const { page } = result;
  const time = async () => Number.parseFloat((await page.locator(".player-time").textContent()) ?? "");
  await page.selectOption("#speed", "1");
  await page.click("button.primary");
  await until(async () => (await time()) > 2, "two seconds");
  await page.getByRole("button", { name: "Pause or continue" }).click();
  await page.waitForTimeout(300);
  const paused = await time();
  await page.locator("#slider-radius").fill("0.017");
  await until(async () => page.url().includes("radius"), "a new run");
  await until(async () => Math.abs((await time()) - paused) < 0.02, "the same time");
  await page.waitForTimeout(300);
  assert.ok(Math.abs((await time()) - paused) < 0.02, "the new run is paused, too");
  await page.selectOption("#speed", "Infinity");
  await page.getByRole("button", { name: "Pause or continue" }).click();
  const digest = page.locator(".result .digest");
  await digest.waitFor();
  const link = new URLSearchParams(new URL(page.url()).hash.slice(1));
  const again = await page.evaluate(
    async (set) =>
      (await window.feeler.run({ experiment: "cap-closing", seed: 0, sensing: "direct", set })).digest,
    link.getAll("set"),
  );
  assert.equal(await digest.textContent(), again);
  assert.equal(await page.getByText("You changed the run at").count(), 0);
  nothingElse(result);
});

test("twenty runs one after the other show their scenes", { skip }, async () => {
  const result = await opened("#experiment=cap-closing&seed=0&sensing=direct");
  const { page } = result;
  for (let run = 0; run < 20; run++) {
    await page.click("button.primary");
    await page.locator(".run-view canvas").first().waitFor();
  }
  assert.equal(await page.locator(".run-view").count(), 1);
  nothingElse(result);
});

test("a setting out of range is refused in a sentence", { skip }, async () => {
  const { page } = await opened("#experiment=cap-closing&seed=0&sensing=direct&set=control.period%3D-1");
  await page.click("button.primary");
  await page.getByText("control.period").first().waitFor();
});

test("an unknown experiment in a link is refused in a sentence", { skip }, async () => {
  const { page } = await opened("#experiment=bottle-opening");
  await page.getByText('There is no built-in experiment "bottle-opening"').waitFor();
  assert.ok(await page.locator("button.primary").isDisabled());
});

test("a recording is reported, and a damaged file is refused in a sentence", { skip }, async () => {
  const out = folder();
  program(out, "run", "cap-closing", "--sensing", "direct", "--out", "run");
  const { page } = await opened();
  await page.getByRole("tab", { name: "Your recording" }).click();
  await page.setInputFiles("#recording", join(out, "run", "recording.mcap"));
  const frame = page.frameLocator("iframe.report");
  await frame.getByRole("heading", { name: "cap-closing" }).first().waitFor();
  const damaged = join(out, "damaged.mcap");
  writeFileSync(damaged, "not a recording");
  await page.setInputFiles("#recording", damaged);
  await page.getByText("damaged.mcap:").waitFor();
});

test("every lesson can be started, and the first is solved by a high threshold", { skip }, async () => {
  const { page } = await opened();
  await page.getByRole("tab", { name: "Learn" }).click();
  assert.equal(await page.locator(".lesson").count(), 5);
  await page.getByRole("button", { name: /What SLIP sees/ }).click();
  await page.selectOption("#speed", "Infinity");
  await page.locator("#slider-slip-threshold").fill("32");
  await page.click("button.primary");
  await page.locator(".result").waitFor();
  await page.getByRole("tab", { name: "Learn" }).click();
  await page.getByText("✓ Solved.").waitFor();
});

test("a phone shows the page without scrolling sideways", { skip }, async () => {
  const { page } = await opened("", { viewport: { width: 390, height: 800 } });
  await page.click("button.primary");
  // Forces make the tables of the fingertips wider.
  await page
    .locator(".fingertip td", { hasText: /^0\.\d+\sN$/ })
    .first()
    .waitFor();
  const width = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(width <= 390, `${width} px`);
});

test("the page is small enough", { skip }, () => {
  const { size } = statSync(file);
  assert.ok(size <= LARGEST, `${size} bytes`);
});
