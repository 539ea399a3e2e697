// Makes the animated image of the README from a report's scene: one stroke of the run in real time, as a looping GIF.
// usage: node tools/moving_picture.mjs REPORT.html OUT.gif
import gifenc from "gifenc";
import { execSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [WIDTH, HEIGHT] = [480, 300];
/** Frame interval (ms); GIF has a resolution of 10 ms. Rows are 10 ms apart. */
const DELAY = 80;
const ROWS = DELAY / 10;
/** Index into `run.strokes`: in the first stroke the cap turns farthest. */
const STROKE = 0;
/** Few colours without dithering make a small file. The last index means "same as in the previous frame". */
const COLOURS = 63;
/** Zooms in so that the domes fill the image; the arms may be cropped. */
const NEARER = '.scene-buttons button[title^="Zoom in"]';
/** Uniform background; the page's gradient would need many colours. */
const GROUND = "#f6f7f8";
/** Shows only the scene, at the size of the image. */
const STYLE = `
  body * { visibility: hidden; }
  .figures { display: none !important; }
  .scene-canvas {
    position: fixed !important; inset: 0 auto auto 0; width: ${WIDTH}px; height: ${HEIGHT}px;
    min-height: 0 !important; border: 0 !important;
  }
`;

const [report, out] = process.argv.slice(2);
if (!report || !out) throw new Error("usage: node tools/moving_picture.mjs REPORT.html OUT.gif");

const frames = await pictures(pathToFileURL(resolve(report)).href);
const gif = animation(frames);
writeFileSync(out, gif);
console.log(`${out}: ${frames.length} frames, ${(gif.length / 1000).toFixed(0)} kB`);

/** Pixels (RGBA) of the scene at every ROWS-th row of the stroke. */
async function pictures(url) {
  const executablePath = process.env["CHROMIUM"] ?? execSync("command -v chromium").toString().trim();
  // WebGL without a graphics card, as in e2e/browser.ts.
  const args = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
  const browser = await chromium.launch({ executablePath, args });
  try {
    const page = await browser.newPage({ viewport: { width: WIDTH, height: HEIGHT }, colorScheme: "light" });
    page.setDefaultTimeout(180_000);
    // Without fences, the scene cannot detect slow drawing and keeps its full resolution.
    await page.addInitScript(() => (WebGL2RenderingContext.prototype.fenceSync = () => null));
    await page.goto(url);
    await page.locator(".player").waitFor();
    await page.addStyleTag({ content: STYLE });
    const stroke = await page.evaluate(
      (index) => JSON.parse(document.querySelector("#page-data").textContent).run.strokes[index],
      STROKE,
    );
    await page.waitForFunction(
      (width) => document.querySelector(".scene-canvas canvas").width === width,
      WIDTH,
    );
    for (let i = 0; i < 2; i++) await page.locator(NEARER).dispatchEvent("click");
    const frames = [];
    for (let row = stroke.start; row < stroke.end; row += ROWS) {
      const pixels = await page.evaluate(picture, { row, ground: GROUND });
      // A copy, because gifenc reads the whole memory underlying a Buffer.
      frames.push(Uint8Array.from(Buffer.from(pixels, "base64")));
    }
    return frames;
  } finally {
    await browser.close();
  }
}

/** In the page: shows a row and returns the scene's pixels in base64. */
function picture({ row, ground }) {
  const input = document.querySelector(".player input");
  input.value = String(row);
  input.dispatchEvent(new Event("input", { bubbles: true }));
  // Runs after the page's own callback in the same frame; later, a WebGL canvas is empty.
  return new Promise((done) =>
    requestAnimationFrame(() => {
      const scene = document.querySelector(".scene-canvas canvas");
      const { width, height } = scene;
      const context = new OffscreenCanvas(width, height).getContext("2d", { willReadFrequently: true });
      context.fillStyle = ground;
      context.fillRect(0, 0, width, height);
      context.drawImage(scene, 0, 0);
      const { data } = context.getImageData(0, 0, width, height);
      let text = "";
      for (let i = 0; i < data.length; i += 0x8000)
        text += String.fromCharCode(...data.subarray(i, i + 0x8000));
      done(btoa(text));
    }),
  );
}

/**
 * Encodes the frames as a GIF with a common palette; each frame contains only the pixels that differ from the previous
 * one.
 */
function animation(frames) {
  const { GIFEncoder, applyPalette, quantize } = gifenc;
  const palette = quantize(Uint8Array.from(Buffer.concat(frames)), COLOURS);
  const same = palette.length;
  palette.push([0, 0, 0]);
  const encoder = GIFEncoder();
  let before;
  for (const frame of frames) {
    const colours = applyPalette(frame, palette.slice(0, same));
    const changed = before ? colours.map((colour, i) => (colour === before[i] ? same : colour)) : colours;
    encoder.writeFrame(changed, WIDTH, HEIGHT, {
      palette: before ? undefined : palette,
      delay: DELAY,
      transparent: before !== undefined,
      transparentIndex: same,
      dispose: 1, // Keep the frame; the next one only changes pixels.
    });
    before = colours;
  }
  encoder.finish();
  return encoder.bytes();
}
