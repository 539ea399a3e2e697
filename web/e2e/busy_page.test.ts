/** A page that does nothing for a time, at the end of a run of the program itself. */
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import type { Browser } from "playwright-core";
import { launch, open } from "./browser";
import { Program, folder, killAll, skip } from "./feeler";

/**
 * How long the page is busy, ms: until all buffers on the way to it are full, and the program sends it no more rows; not
 * until the program takes it for gone.
 */
const BUSY = 9500;
/** When the run ends meanwhile, ms: so late that the page is free before the program has left. */
const END = 8500;

describe("a busy page", { skip }, () => {
  let browser: Browser;
  before(async () => {
    browser = await launch();
  });
  after(async () => {
    killAll();
    await browser.close();
  });

  test("is told how the run ended all the same", async () => {
    const run = ["run", "cap-closing", "--sensing=direct", "--out=run", "--speed=0.2"];
    const program = new Program(folder(), [...run, "--view", "--no-open"]);
    const { page, errors } = await open(browser, await program.url());
    await page.getByText(/SEARCH of stroke 1 of 4/).waitFor();
    setTimeout(() => program.interrupt(), END);
    await page.evaluate((busy) => {
      for (const until = Date.now() + busy; Date.now() < until;);
    }, BUSY);
    await page.getByText(/The run was interrupted: .*No more rows come/).waitFor();
    assert.equal(await page.locator(".live-notice").isVisible(), false);
    assert.deepEqual(errors, []);
    assert.equal(await program.ended, 1, program.said);
  });
});
