// Makes a moving picture of a report's scene, the README's: one stroke of the run, in real time, as a GIF that loops.
// usage: node tools/moving_picture.mjs REPORT.html OUT.gif
import gifenc from "gifenc";
import { execSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [WIDTH, HEIGHT] = [480, 300];
/** Between frames, ms: a GIF counts in hundredths of a second. Rows are 10 ms apart. */
const DELAY = 80;
const ROWS = DELAY / 10;
/** Of `run.strokes`: the first, as in it the cap turns farthest. */
const STROKE = 0;
/** Few colours, and no dithering, make a small file. The last index says "as in the frame before". */
const COLOURS = 63;
/** Brings the scene nearer: the domes fill the picture, the arms need not be seen. */
const NEARER = '.scene-buttons button[title^="Nearer"]';
/** Even: a gradient, as on the page, would take many colours. */
const GROUND = "#f6f7f8";
/** The scene in the picture's size, and nothing else that would take time to draw. */
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

/** The scene's pixels (RGBA) at every ROWS-th row of the stroke. */
async function pictures(url) {
  const executablePath = process.env["CHROMIUM"] ?? execSync("command -v chromium").toString().trim();
  // WebGL without a graphics card, as in e2e/browser.ts.
  const args = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
  const browser = await chromium.launch({ executablePath, args });
  try {
    const page = await browser.newPage({ viewport: { width: WIDTH, height: HEIGHT }, colorScheme: "light" });
    page.setDefaultTimeout(180_000);
    // The scene draws fewer pixels where drawing is slow, and learns that from fences. Here time does not matter.
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
      // Copied, as gifenc reads the whole of the memory that is under a Buffer.
      frames.push(Uint8Array.from(Buffer.from(pixels, "base64")));
    }
    return frames;
  } finally {
    await browser.close();
  }
}

/** In the page: shows a row and gives the scene's pixels, in base64. */
function picture({ row, ground }) {
  const input = document.querySelector(".player input");
  input.value = String(row);
  input.dispatchEvent(new Event("input", { bubbles: true }));
  // The page draws in the browser's next frame. This comes after it in the same frame, as later a canvas of WebGL is empty.
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

/** The frames as a GIF: one palette for all, and of each frame only what differs from the one before. */
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
      dispose: 1, // A frame stays, for the next to change.
    });
    before = colours;
  }
  encoder.finish();
  return encoder.bytes();
}
