/** Report page of a run: one current time for scene, fingertips and figures. */
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import type { Browser, Page } from "playwright-core";
import { html, reportBody, reportPage } from "../sample/document";
import { moment, quantity } from "../src/format";
import { launch, open, until } from "./browser";
import { data, run, sample, write } from "./pages";

let browser: Browser;
before(async () => {
  browser = await launch();
});
after(() => browser.close());

async function opened(options = {}): Promise<{ page: Page; errors: string[] }> {
  const { page, errors } = await open(browser, sample, options);
  await page.locator(".uplot").first().waitFor();
  await page.waitForTimeout(300);
  return { page, errors };
}

const time = (page: Page) => page.locator(".player-time").innerText();

const showsTime = (page: Page, row: number) =>
  until(async () => (await time(page)) === moment(run.rows[row]?.time ?? NaN), `row ${row} is not shown`);

async function seek(page: Page, row: number): Promise<void> {
  await page.locator(".player input").fill(String(row));
  await showsTime(page, row);
}

test("scrubbing changes the scene and the fingertips", async () => {
  const { page, errors } = await opened();
  for (const canvas of [".scene-canvas canvas", ".fingertip canvas"]) {
    const place = page.locator(canvas).first();
    await seek(page, 0);
    await page.waitForTimeout(300);
    const before = await place.screenshot();
    await seek(page, 220);
    await until(async () => !before.equals(await place.screenshot()), `${canvas} changes`);
  }
  assert.deepEqual(errors, []);
  await page.context().close();
});

test("the values at the cursor equal the recorded values", async () => {
  const { page } = await opened();
  const figure = page.locator("#fig-08");
  await figure.scrollIntoViewIfNeeded();
  const over = figure.locator(".u-over").first();
  const box = await over.boundingBox();
  assert.ok(box);
  await over.hover({ position: { x: 0.42 * box.width, y: 40 } });
  await until(async () => (await time(page)) !== moment(0), "the cursor changes the time");
  const shown = await time(page);
  const row = run.rows.find((row) => moment(row.time) === shown);
  assert.ok(row, shown);
  const values = await figure.locator(".legend-value").allInnerTexts();
  const expected = [
    quantity(row.graspForce[0] ?? NaN, "N"),
    quantity(row.graspForce[1] ?? NaN, "N"),
    quantity(row.torque, "mN·m", 1e3),
  ];
  assert.deepEqual(values, expected);
  // All figures share the cursor.
  const other = await page.locator("#fig-09 .u-cursor-x").first().getAttribute("style");
  const own = await figure.locator(".u-cursor-x").first().getAttribute("style");
  assert.equal(other, own);
  await page.context().close();
});

test("a drag zooms a figure, a double click resets it", async () => {
  const { page } = await opened();
  const figure = page.locator("#fig-08");
  await figure.scrollIntoViewIfNeeded();
  const over = figure.locator(".u-over").first();
  const picture = async () => {
    await page.mouse.move(5, 5);
    // Wait until the cursor has disappeared.
    await page.waitForTimeout(400);
    return figure
      .locator("canvas")
      .first()
      .evaluate((canvas) => (canvas as HTMLCanvasElement).toDataURL());
  };
  const all = await picture();
  const box = await over.boundingBox();
  assert.ok(box);
  await page.mouse.move(box.x + 60, box.y + 50);
  await page.mouse.down();
  await page.mouse.move(box.x + 160, box.y + 50, { steps: 4 });
  await page.mouse.up();
  await until(async () => (await picture()) !== all, "the figure zooms");
  await over.dblclick({ position: { x: 80, y: 50 } });
  await until(async () => (await picture()) === all, "the figure is reset");
  await page.context().close();
});

test("keys play, pause, step, and open the help", async () => {
  const { page } = await opened();
  await page.keyboard.press("ArrowRight");
  await showsTime(page, 1);
  await page.keyboard.press("Shift+ArrowRight");
  await showsTime(page, 51);
  await page.keyboard.press("ArrowLeft");
  await showsTime(page, 50);
  await page.keyboard.press("End");
  await showsTime(page, run.rows.length - 1);
  await page.keyboard.press("Home");
  await showsTime(page, 0);
  await page.keyboard.press("]");
  await showsTime(page, run.strokes[1]?.start ?? NaN);
  await page.keyboard.press("Space");
  await until(async () => (await time(page)) !== moment(run.rows[480]?.time ?? 0), "it plays");
  await page.keyboard.press("Space");
  const stopped = await time(page);
  await page.waitForTimeout(300);
  assert.equal(await time(page), stopped);
  await page.keyboard.press("?");
  await page.locator("dialog[open]").waitFor();
  assert.match(await page.locator("dialog").innerText(), /home view/);
  await page.keyboard.press("Escape");
  await page.context().close();
});

test("playback has the selected speed", async () => {
  const { page } = await opened();
  await page.locator(".player select").selectOption("4");
  await page.keyboard.press("Space");
  await page.waitForTimeout(1500);
  await page.keyboard.press("Space");
  const shown = Number.parseFloat(await time(page));
  assert.ok(shown > 2, `${shown} s after 1.5 s at 4 times`);
  await page.context().close();
});

test("a claim jumps to its time", async () => {
  const { page } = await opened();
  await page.locator(".jump").first().click();
  await showsTime(page, run.strokes[0]?.move[0] ?? NaN);
  await page
    .locator("tr[data-time] td")
    .first()
    .click({ position: { x: 5, y: 5 } });
  await showsTime(page, run.strokes[3]?.move[0] ?? NaN);
  await page.context().close();
});

test("a point with a command shows it", async () => {
  const { page } = await opened();
  const over = page.locator("#fig-14 .u-over");
  await over.scrollIntoViewIfNeeded();
  const box = await over.boundingBox();
  assert.ok(box);
  for (let x = 0.1; x < 0.95; x += 0.05) {
    await over.hover({ position: { x: x * box.width, y: (0.9 - 0.75 * x) * box.height } });
    if (await page.locator("#fig-14 .tooltip").isVisible()) break;
  }
  assert.match(await page.locator("#fig-14 .tooltip").innerText(), /feeler run --trial \S+ \d+/);
  await page.context().close();
});

test("a click on a figure jumps to that time during playback", async () => {
  const { page } = await opened();
  const over = page.locator("#fig-08 .u-over").first();
  await over.scrollIntoViewIfNeeded();
  const box = await over.boundingBox();
  assert.ok(box);
  await page.keyboard.press(" ");
  await until(async () => (await time(page)) !== moment(run.rows[0]?.time ?? NaN), "the run plays");
  await over.click({ position: { x: 0.9 * box.width, y: 50 } });
  const last = run.rows.at(-1)?.time ?? NaN;
  await until(async () => parseFloat(await time(page)) > 0.85 * last, "the time of the click is shown");
  await page.context().close();
});

test("a finger on a figure sets the time", async () => {
  const { page, errors } = await opened({
    viewport: { width: 390, height: 844 },
    isMobile: true,
    hasTouch: true,
  });
  const over = page.locator("#fig-08 .u-over").first();
  await over.scrollIntoViewIfNeeded();
  const before = await time(page);
  await over.tap({ position: { x: 150, y: 60 } });
  await until(async () => (await time(page)) !== before, "the tap changes the time");
  assert.deepEqual(errors, []);
  await page.context().close();
});

/**
 * The scene without its buttons, as 32 x 24 gray values from 0 to 1. These are nearly independent of the resolution,
 * but depend on the camera.
 */
async function grays(page: Page): Promise<number[]> {
  const scene = page.locator(".scene-canvas canvas");
  const picture = await scene.screenshot({ mask: [page.locator(".scene-buttons")] });
  return page.evaluate(
    async (bytes) => {
      const context = new OffscreenCanvas(32, 24).getContext("2d");
      if (!context) throw new Error("no canvas");
      context.imageSmoothingQuality = "high";
      context.drawImage(await createImageBitmap(new Blob([new Uint8Array(bytes)])), 0, 0, 32, 24);
      const { data } = context.getImageData(0, 0, 32, 24);
      const gray = (pixel: Uint8ClampedArray) =>
        pixel.subarray(0, 3).reduce((sum, part) => sum + part, 0) / 765;
      return Array.from({ length: data.length / 4 }, (_, i) => gray(data.subarray(4 * i, 4 * i + 4)));
    },
    [...picture],
  );
}

test("home view and zoom move the camera", async () => {
  const { page } = await opened();
  const home = await grays(page);
  const fromHome = async () => {
    const now = await grays(page);
    return now.reduce((sum, gray, i) => sum + Math.abs(gray - (home[i] ?? NaN)), 0) / now.length;
  };
  await page.getByRole("button", { name: "Zoom in" }).click();
  let nearer = 0;
  await until(async () => (nearer = await fromHome()) > 0.01, "the camera is nearer");
  await page.keyboard.press("h");
  await until(async () => (await fromHome()) < nearer / 4, "the camera goes home");
  await page.context().close();
});

const run0 = data.run;
const BAD: [what: string, text: string, says: RegExp][] = [
  ["invalid JSON", "{", /damaged/],
  ["another version", JSON.stringify({ ...data, version: 2 }), /version 2/],
  ["no rows", JSON.stringify({ ...data, run: { ...run0, data: "" } }), /damaged|truncated/],
  [
    "a truncated blob",
    JSON.stringify({ ...data, run: { ...run0, data: run0?.data.slice(0, 2000) } }),
    /damaged/,
  ],
  ["no time", JSON.stringify({ ...data, run: { ...run0, columns: run0?.columns.slice(1) } }), /“time”/],
];

for (const [what, text, says] of BAD) {
  test(`a page with ${what} shows an error`, async () => {
    const url = write("bad.html", html({ title: "bad", body: reportBody(data), data: text }));
    const { page, errors } = await open(browser, url);
    await page.locator(".problem").first().waitFor();
    assert.match(await page.locator(".problem").first().innerText(), says);
    assert.ok(await page.locator("figure > svg").first().isVisible(), "the static figures remain");
    assert.deepEqual(errors, []);
    await page.context().close();
  });
}

test("a figure without its column remains static", async () => {
  const columns = run0?.columns.map((column) =>
    column.name === "torque" ? { ...column, name: "renamed" } : column,
  );
  const page0 = { ...data, run: run0 && { ...run0, columns: columns ?? [] } };
  const { page, errors } = await open(browser, write("lacks.html", reportPage(page0)));
  await page.locator("#fig-08 .note").waitFor();
  assert.match(await page.locator("#fig-08 .note").innerText(), /“torque”/);
  assert.ok(await page.locator("#fig-08 > svg").isVisible());
  assert.ok(await page.locator("#fig-14 .uplot").isVisible());
  assert.deepEqual(errors, []);
  await page.context().close();
});

test("without WebGL the page shows a message, and everything else works", async () => {
  const plain = await launch(["--disable-3d-apis"]);
  const { page, errors } = await open(plain, sample);
  await page.locator(".scene-canvas .problem").waitFor();
  assert.match(await page.locator(".scene-canvas .problem").innerText(), /no WebGL/);
  await seek(page, 220);
  assert.deepEqual(errors, []);
  await plain.close();
});
