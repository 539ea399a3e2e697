/** Access control of the live page. */
import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import type { Browser } from "playwright-core";
import { launch, open } from "./browser";
import { Program, ask, folder, killAll, skip } from "./feeler";

const UPGRADE = {
  Connection: "Upgrade",
  Upgrade: "websocket",
  "Sec-WebSocket-Version": "13",
  "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
};

describe("a client of a live page", { skip }, () => {
  let browser: Browser;
  let program: Program;
  let url: URL;

  before(async () => {
    browser = await launch();
    // Slow enough to run until the tests interrupt it.
    const run = ["run", "cap-closing", "--sensing=direct", "--out=run", "--speed=0.02"];
    program = new Program(folder(), [...run, "--view", "--no-open"]);
    url = new URL(await program.url());
  });
  after(async () => {
    killAll();
    await browser.close();
  });

  test("is rejected with a wrong token", async () => {
    const wrong = new URL(`/${"0".repeat(url.pathname.length - 2)}/`, url);
    const page = await browser.newPage();
    const answer = await page.goto(wrong.href);
    assert.equal(answer?.status(), 403);
    assert.match(await page.locator("body").innerText(), /use the complete address that feeler printed/);
    assert.equal(await page.locator("#page-data").count(), 0);
    await page.close();
  });

  test("is rejected with a foreign host name", async () => {
    const { status, body } = await ask(url.href, { Host: `evil.example:${url.port}` });
    assert.equal(status, 403);
    assert.match(body, /expected the address.*evil\.example/);
    assert.equal((await ask(url.href, {})).status, 200);
  });

  test("cannot open the socket from another origin", async () => {
    // In the browser: a page of another origin that knows the complete address.
    const foreign = await browser.newPage();
    await foreign.goto("data:text/html,<title>another page</title>");
    const opened = await foreign.evaluate(
      (socket) =>
        new Promise<boolean>((resolve) => {
          const connection = new WebSocket(socket);
          connection.addEventListener("open", () => resolve(true));
          connection.addEventListener("error", () => resolve(false));
        }),
      `ws://${url.host}${url.pathname}live`,
    );
    assert.equal(opened, false);
    await foreign.close();
    // The error message, which browsers hide from pages.
    const socket = new URL("live", url).href;
    const { status, body } = await ask(socket, { ...UPGRADE, Origin: "http://evil.example" });
    assert.equal(status, 403);
    assert.match(body, /got one from "http:\/\/evil\.example"/);
    assert.equal((await ask(socket, { ...UPGRADE, Origin: url.origin })).status, 101);
  });

  test("opens the page with the printed address", async () => {
    const { page, errors } = await open(browser, url.href);
    await page.getByText(/SEARCH of stroke 1 of 4/).waitFor();
    assert.deepEqual(errors, []);
    assert.equal(await program.interrupt(), 1);
    await page.getByText(/The run was interrupted.*No further data/).waitFor();
  });
});
