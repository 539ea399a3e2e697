/**
 * Tests of the tab *Your fingertip*. Recordings of real sensors are in `FEELER_DATA`, by default
 * `../shared/data` next to the repository; `FEELER_FFMPEG` converts them.
 */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import type { Browser, Page } from "playwright-core";
import { launch, until } from "./browser";
import { folder, nothingElse, opened, program, simulatedFingertip, skip } from "./playground_page";

const data = process.env["FEELER_DATA"] ?? fileURLToPath(new URL("../../../../shared/data", import.meta.url));
const ffmpeg = process.env["FEELER_FFMPEG"];
const skipReal = skip || (existsSync(data) ? false : `no recordings in ${data}`);
const skipVideo = skipReal || (ffmpeg ? false : "needs FEELER_FFMPEG");

let browser: Browser;
before(async () => {
  if (!skip) browser = await launch();
});
after(async () => {
  if (!skip) await browser.close();
});

async function openedTab(from = browser) {
  const result = await opened(from);
  await result.page.getByRole("tab", { name: "Your fingertip" }).click();
  return result;
}

async function saved(page: Page, name: string): Promise<string> {
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.getByRole("button", { name }).click(),
  ]);
  return readFileSync(await download.path(), "utf8");
}

/** A PNG image of dark dots, or of none. */
const drawn = (page: Page, dots: boolean) =>
  page.evaluate((dots) => {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [320, 240];
    const context = canvas.getContext("2d");
    if (!context) throw new Error("no canvas");
    context.fillStyle = "#c0c0c0";
    context.fillRect(0, 0, 320, 240);
    context.fillStyle = "#202020";
    for (let x = 40; dots && x < 300; x += 30) {
      for (let y = 30; y < 220; y += 30) {
        context.beginPath();
        context.arc(x, y, 6, 0, 2 * Math.PI);
        context.fill();
      }
    }
    return canvas.toDataURL("image/png").split(",")[1] ?? "";
  }, dots);

test(
  "markers of an image are located and saved, and an image without markers is refused",
  { skip },
  async () => {
    const result = await openedTab();
    const { page } = result;
    const choose = async (name: string, dots: boolean) =>
      page.setInputFiles("#fingertip", {
        name,
        mimeType: "image/png",
        buffer: Buffer.from(await drawn(page, dots), "base64"),
      });
    await choose("dots.png", true);
    await page.getByText("63 markers.").waitFor();
    assert.match(await saved(page, "as a layout file"), /^version = /m);
    await choose("plain.png", false);
    await page.getByText("plain.png: no element found").waitFor();
    nothingElse(result);
  },
);

test("a calibration gives the forces of the program", { skip }, async () => {
  const own = simulatedFingertip();
  const image = "loads/00010.png";
  const words = ["--layout", "layout.toml", "--calibration", "calibration.toml"];
  program(own, "sense", image, ...words, "-o", "forces.csv");
  const result = await openedTab();
  const { page } = result;
  await page.setInputFiles("#fingertip", join(own, "calibration.toml"));
  await page.getByText("The calibration is not used: No markers").waitFor();
  await page.setInputFiles("#fingertip", join(own, "layout.toml"));
  await page.getByText("41 markers.").waitFor();
  await page.setInputFiles("#fingertip", join(own, "calibration.toml"));
  await page.getByText("The calibration is in use.").waitFor();
  await page.setInputFiles("#fingertip", join(own, image));
  await page.getByText("the images do not match the calibration").waitFor();
  await page.setInputFiles("#fingertip", join(own, "loads/untouched.png"));
  await page.getByText("TOUCH off").waitFor();
  await page.setInputFiles("#fingertip", join(own, image));
  await page.getByText("TOUCH on").waitFor();
  const force = (line: string) => line.split(",").slice(-3).map(Number);
  const rows = (table: string) => table.trim().split("\n").slice(1).map(force);
  const expected = rows(readFileSync(join(own, "forces.csv"), "utf8"));
  const actual = rows(await saved(page, "as a table"));
  assert.equal(actual.length, 41);
  for (const [element, forces] of expected.entries()) {
    for (const [axis, value] of forces.entries())
      // The table has four decimals.
      assert.ok(
        Math.abs(value - (actual[element]?.[axis] ?? NaN)) < 1e-4,
        `element ${element}, axis ${axis}`,
      );
  }
  const touching = expected.some(([, , z = 0]) => z > 0.1);
  assert.ok(touching, "the load is felt");
  await page.locator("#threshold-touch").fill("1000");
  await page.locator("#threshold-touch").press("Enter");
  await page.setInputFiles("#fingertip", join(own, "loads/00011.png"));
  await page.getByText(/Grasp force [1-9].*TOUCH off/).waitFor();
  nothingElse(result);
});

test("images of another size than the layout's are refused", { skip }, async () => {
  const own = simulatedFingertip();
  const { page } = await openedTab();
  await page.setInputFiles("#fingertip", join(own, "layout.toml"));
  await page.getByText("41 markers.").waitFor();
  const buffer = Buffer.from(await drawn(page, true), "base64");
  await page.setInputFiles("#fingertip", { name: "dots.png", mimeType: "image/png", buffer });
  await page.getByText("expected images of 640 x 480 px as in the layout, got 320 x 240 px").waitFor();
});

test("a TacTip has the markers of the program", { skip: skipReal }, async () => {
  const images = join(data, "tactip-surface3d-tap", "images");
  const image = join(images, readdirSync(images).sort()[0] ?? "");
  const expected = /^(\d+) elements/.exec(program(folder(), "locate", image, "-o", "layout.toml"))?.[1];
  const { page } = await openedTab();
  await page.setInputFiles("#fingertip", image);
  await page.getByText(`${expected} markers.`).waitFor();
});

/** Converts a video of a GelSight to the file `name`. */
function gelsight(name: string, ...options: string[]): string {
  const out = join(folder(), name);
  const video = join(data, "gelsight-slip", "lemon-hold.avi");
  execFileSync(ffmpeg ?? "", ["-v", "error", "-i", video, ...options, out]);
  return out;
}

/** Minimum number of markers in the GelSight video, without those that the border cuts. */
const LEAST_MARKERS = 50;

test("a video of a GelSight is tracked to its end", { skip: skipVideo }, async () => {
  const video = gelsight("gel.webm", "-c:v", "libvpx", "-b:v", "2M", "-deadline", "realtime");
  const result = await openedTab();
  const { page } = result;
  await page.locator("#heat-map").check();
  await page.setInputFiles("#fingertip", video);
  await page.getByText("The video has ended").waitFor();
  const table = (await saved(page, "as a table")).trim().split("\n").slice(1);
  const markers = new Set(table.map((line) => line.split(",")[1])).size;
  assert.ok(markers >= LEAST_MARKERS, `${markers} markers`);
  const confident = table.filter((line) => Number(line.split(",")[6]) > 0.5).length;
  assert.ok(confident > 0.9 * table.length, `${confident} of ${table.length} are confident`);
  nothingElse(result);
});

test("a camera is tracked", { skip: skipVideo }, async () => {
  const video = gelsight("gel.y4m", "-pix_fmt", "yuv420p");
  const camera = await launch([
    "--use-fake-ui-for-media-stream",
    "--use-fake-device-for-media-stream",
    `--use-file-for-fake-video-capture=${video}`,
  ]);
  try {
    const { page } = await openedTab(camera);
    await page.getByRole("button", { name: "Use a camera" }).click();
    await page.getByText(/\d+ markers\./).waitFor();
    const status = (await page.locator("[role=status]").allTextContents()).join();
    const markers = Number(/(\d+) markers\./.exec(status)?.[1]);
    assert.ok(markers >= LEAST_MARKERS, status);
    await until(async () => (await saved(page, "as a table")).split("\n").length > 20 * markers, "20 images");
    await page.getByRole("button", { name: "Stop the video" }).click();
    await page.getByText("Stopped.").waitFor();
  } finally {
    await camera.close();
  }
});

test("a missing camera is reported", { skip }, async () => {
  const { page } = await openedTab();
  await page.getByRole("button", { name: "Use a camera" }).click();
  await page.getByText("The camera cannot be used:").waitFor();
});
