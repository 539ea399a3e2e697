/** Live page that is blocked while the run ends. */
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import { setTimeout } from "node:timers/promises";
import type { Browser } from "playwright-core";
import { launch, open } from "./browser";
import { Program, folder, killAll, skip } from "./feeler";

/** Time after which all buffers are full and the program sends no rows (ms). A shorter time only weakens the test. */
const FULL = 8500;

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
    // A dialog blocks the page until it is closed.
    page.on("dialog", async (dialog) => {
      await setTimeout(FULL);
      void program.interrupt();
      await program.says(/interrupted/);
      await dialog.accept();
    });
    await page.evaluate(() => alert("busy"));
    await page.getByText(/The run was interrupted: .*No further data/).waitFor();
    assert.equal(await page.locator(".live-notice").isVisible(), false);
    assert.deepEqual(errors, []);
    assert.equal(await program.ended, 1, program.said);
  });
});
