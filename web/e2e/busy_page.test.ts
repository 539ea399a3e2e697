/** Live page that is blocked while the run ends. */
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import type { Browser } from "playwright-core";
import { launch, open } from "./browser";
import { Program, folder, killAll, skip } from "./feeler";

/**
 * Time that the page is blocked (ms): long enough to fill all buffers, so that the program stops sending rows, but too
 * short for the program to drop the connection.
 */
const BUSY = 9500;
/** Time at which the run ends meanwhile (ms): late enough that the page responds again before the program exits. */
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

  test("still shows how the run ended", async () => {
    const run = ["run", "cap-closing", "--sensing=direct", "--out=run", "--speed=0.2"];
    const program = new Program(folder(), [...run, "--view", "--no-open"]);
    const { page, errors } = await open(browser, await program.url());
    await page.getByText(/SEARCH of stroke 1 of 4/).waitFor();
    setTimeout(() => program.interrupt(), END);
    await page.evaluate((busy) => {
      for (const until = Date.now() + busy; Date.now() < until;);
    }, BUSY);
    await page.getByText(/The run was interrupted: .*No further data/).waitFor();
    assert.equal(await page.locator(".live-notice").isVisible(), false);
    assert.deepEqual(errors, []);
    assert.equal(await program.ended, 1, program.said);
  });
});
