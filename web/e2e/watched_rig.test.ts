/** A distributed rig, watched and commanded in the browser. */
import assert from "node:assert/strict";
import { createServer } from "node:net";
import { after, before, describe, test } from "node:test";
import type { Browser, Page } from "playwright-core";
import { launch, open, until } from "./browser";
import { Program, folder, killAll, skip } from "./feeler";

/** An unused port. */
function freePort(): Promise<number> {
  return new Promise((resolve) => {
    const server = createServer().listen(0, "127.0.0.1", () => {
      const address = server.address();
      server.close(() => resolve(typeof address === "object" ? (address?.port ?? 0) : 0));
    });
  });
}

describe("a rig in the browser", { skip }, () => {
  const where = folder();
  let browser: Browser;
  let hand: Program;
  let view: Program;
  let page: Page;
  let errors: string[];

  before(async () => {
    browser = await launch();
    const endpoint = `tcp/127.0.0.1:${await freePort()}`;
    // A busy computer makes data stale at times; the hand resumes when they are fresh again.
    const settings = ["--sensing=direct", "--set=control.resume=fresh", "--set=time_limit=600"];
    const join = ["--connect", endpoint, ...settings];
    const start = (...args: string[]) => new Program(where, args);
    start("world", "cap-closing", "--speed=0.25", ...join);
    for (const finger of ["0", "1"]) start("sense", "rig:", "--publish", "--finger", finger, ...join);
    view = start("view", "cap-closing", "--no-open", ...join);
    ({ page, errors } = await open(browser, await view.url()));
    await page.getByText("No messages received from a hand.").waitFor();
    const listen = ["--listen", endpoint, "--speed=0.25", ...settings];
    hand = start("hand", "cap-closing", "--out=run", ...listen);
  });
  after(async () => {
    killAll();
    await browser.close();
  });

  const time = async () => Number.parseFloat(await page.locator(".player-time").innerText());

  test("is shown while it runs", async () => {
    await page.getByText(/of stroke 1 of 4\./).waitFor();
    await until(async () => (await time()) > 0, "a row is shown");
    const before = await time();
    const canvas = page.locator(".scene-canvas canvas");
    const picture = await canvas.screenshot();
    await until(async () => (await time()) > before + 0.2, "later rows are shown");
    await until(async () => !picture.equals(await canvas.screenshot()), "the scene moves");
  });

  test("is stopped and resumed with the page's buttons", async () => {
    await page.getByRole("button", { name: "Stop the hand" }).click();
    await page.getByText(/the hand is stopped.*the page of feeler view/).waitFor();
    await hand.says(/stopped: .*the page of feeler view/);
    await page.getByRole("button", { name: "Resume the hand" }).click();
    await page.getByText("Resume: the hand has resumed.").waitFor();
  });

  test("is unchanged when the view ends, and the page reports it", async () => {
    assert.equal(await view.interrupt(), 0);
    await page.getByText(/feeler view was ended; the rig was left as it is/).waitFor();
    assert.deepEqual(errors, []);
    assert.equal(await hand.interrupt(), 1);
  });
});
