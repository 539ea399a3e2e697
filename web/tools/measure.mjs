// Measures the time until a report's scene is drawn, and the frame rate during playback.
// usage: node tools/measure.mjs REPORT.html
import { execSync } from "node:child_process";
import { statSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const REPEATS = 5;
/** Duration of playback (ms). */
const PLAYS = 5000;

const [report] = process.argv.slice(2);
if (!report) throw new Error("usage: node tools/measure.mjs REPORT.html");

const executablePath = process.env["CHROMIUM"] ?? execSync("command -v chromium").toString().trim();
// `GPU=1` uses the graphics card; otherwise WebGL is drawn in software, as in e2e/browser.ts.
const software = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const args = ["--no-sandbox", ...(process.env["GPU"] ? ["--ignore-gpu-blocklist"] : software)];
const browser = await chromium.launch({ executablePath, args });
try {
  const runs = [];
  for (let i = 0; i < REPEATS; i++) runs.push(await measure(pathToFileURL(resolve(report)).href));
  const middle = (of) => runs.map(of).sort((a, b) => a - b)[Math.floor(REPEATS / 2)];
  console.log(`file                 ${(statSync(report).size / 1e6).toFixed(2)} MB`);
  console.log(`renderer             ${runs[0].renderer}`);
  console.log(
    `first image after    ${(middle((run) => run.first) / 1000).toFixed(2)} s (median of ${REPEATS})`,
  );
  console.log(`during playback      ${middle((run) => run.rate).toFixed(1)} frames/s (median of ${REPEATS})`);
} finally {
  await browser.close();
}

/** Time from the start of navigation to the first drawn frame (ms), and drawn frames per second. */
async function measure(url) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  page.setDefaultTimeout(180_000);
  await page.addInitScript(() => {
    const drawn = (window.drawn = { frames: 0, first: undefined });
    let isNew = false;
    const context = WebGL2RenderingContext.prototype;
    for (const name of ["drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced"]) {
      const draw = context[name];
      context[name] = function (...values) {
        draw.apply(this, values);
        if (isNew) return;
        isNew = true;
        // A frame ends when the next one starts.
        requestAnimationFrame(() => {
          isNew = false;
          drawn.frames++;
          drawn.first ??= performance.now();
        });
      };
    }
  });
  await page.goto(url);
  await page.waitForFunction(() => window.drawn.first);
  await page.keyboard.press(" ");
  await page.waitForTimeout(500);
  const rate = await page.evaluate(async (time) => {
    const [frames, start] = [window.drawn.frames, performance.now()];
    await new Promise((done) => setTimeout(done, time));
    return (1000 * (window.drawn.frames - frames)) / (performance.now() - start);
  }, PLAYS);
  const renderer = await page.evaluate(() => {
    const gl = document.createElement("canvas").getContext("webgl2");
    const info = gl.getExtension("WEBGL_debug_renderer_info");
    return info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "unknown";
  });
  const first = await page.evaluate(() => window.drawn.first);
  await page.close();
  return { first, rate, renderer };
}
