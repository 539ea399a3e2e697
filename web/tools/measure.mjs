// Measures how soon a report's scene is drawn, and how often while the run plays.
// usage: node tools/measure.mjs REPORT.html
import { execSync } from "node:child_process";
import { statSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const REPEATS = 5;
/** How long it plays, ms. */
const PLAYS = 5000;

const [report] = process.argv.slice(2);
if (!report) throw new Error("usage: node tools/measure.mjs REPORT.html");

const executablePath = process.env["CHROMIUM"] ?? execSync("command -v chromium").toString().trim();
// A graphics card is used where there is one: `GPU=1`; else WebGL is drawn in software, as in e2e/browser.ts.
const software = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const args = ["--no-sandbox", ...(process.env["GPU"] ? ["--ignore-gpu-blocklist"] : software)];
const browser = await chromium.launch({ executablePath, args });
try {
  const runs = [];
  for (let i = 0; i < REPEATS; i++) runs.push(await measure(pathToFileURL(resolve(report)).href));
  const middle = (of) => runs.map(of).sort((a, b) => a - b)[Math.floor(REPEATS / 2)];
  console.log(`file                 ${(statSync(report).size / 1e6).toFixed(2)} MB`);
  console.log(`drawn by             ${runs[0].renderer}`);
  console.log(
    `first picture after  ${(middle((run) => run.first) / 1000).toFixed(2)} s (median of ${REPEATS})`,
  );
  console.log(`while playing        ${middle((run) => run.rate).toFixed(1)} frames/s (median of ${REPEATS})`);
} finally {
  await browser.close();
}

/** Times from the beginning of navigation, ms; frames in which something was drawn, per second. */
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
        // A frame is over when the next one begins.
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
