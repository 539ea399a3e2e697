/** Browser for the tests, with the errors and requests of its pages. */
import assert from "node:assert/strict";
import { execSync } from "node:child_process";
import { isDeepStrictEqual } from "node:util";
import { type Browser, type BrowserContextOptions, chromium, type Page } from "playwright-core";

const FLAGS = [
  "--no-sandbox",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  // WebGL without a graphics card.
  "--use-angle=swiftshader",
  "--enable-unsafe-swiftshader",
  // Without a graphics card, only WebGL needs an emulated one; compositing is faster without it.
  "--disable-gpu-compositing",
];

/** Warning of the browser itself when it reads back WebGL frames for compositing. */
const OWN_WARNING = "GPU stall due to ReadPixels";

/** Maximum time that a test waits for an event (ms). */
const PATIENCE = 180_000;
/** Polling interval (ms). */
const INTERVAL = 50;

export function launch(flags: string[] = []): Promise<Browser> {
  const executablePath = process.env["CHROMIUM"] ?? execSync("command -v chromium").toString().trim();
  return chromium.launch({ executablePath, args: [...FLAGS, ...flags] });
}

export interface Opened {
  page: Page;
  /** Console errors and warnings, and uncaught exceptions. */
  errors: string[];
  /** URLs requested by the page, except its own. */
  requests: string[];
}

/** Opens `url` in a new context, after `prepare` has been called with the empty page. */
export async function open(
  browser: Browser,
  url: string,
  options: BrowserContextOptions = {},
  prepare: (page: Page) => Promise<void> = async () => {},
): Promise<Opened> {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  // A busy computer must not cause a test to fail.
  context.setDefaultTimeout(PATIENCE);
  const page = await context.newPage();
  const [errors, requests]: [string[], string[]] = [[], []];
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("console", (message) => {
    const isOwn = message.type() === "warning" && message.text().includes(OWN_WARNING);
    if (!isOwn && ["error", "warning"].includes(message.type())) errors.push(message.text());
  });
  page.on("request", (request) => {
    if (request.url() !== url) requests.push(request.url());
  });
  await prepare(page);
  await page.goto(url);
  return { page, errors, requests };
}

/** Maximum latency of flags on a live page (ms). */
const FLAG_LATENCY = 100;

/** Prints a latency (ms). Asserts its limit only with `LATENCY=1`, because a busy computer may exceed it. */
export function holdLatency(told: string, latency: number): void {
  console.log(told);
  if (process.env["LATENCY"]) assert.ok(latency < FLAG_LATENCY, told);
}

/** Polls `what`. Returns `false` if it does not become true in time. */
async function comesTrue(what: () => Promise<boolean>): Promise<boolean> {
  for (let waited = 0; waited < PATIENCE; waited += INTERVAL) {
    if (await what()) return true;
    await new Promise((resolve) => setTimeout(resolve, INTERVAL));
  }
  return false;
}

/** Waits until `what` is true. `message` describes the condition. */
export async function until(what: () => Promise<boolean>, message: string): Promise<void> {
  if (!(await comesTrue(what))) throw new Error(`not within ${PATIENCE / 1000} s: ${message}`);
}

/** Waits until `read` returns `expected`. `message` describes the value. */
export async function eventually<T>(read: () => Promise<T>, expected: T, message: string): Promise<void> {
  let actual: T | undefined;
  await comesTrue(async () => isDeepStrictEqual((actual = await read()), expected));
  assert.deepEqual(actual, expected, message);
}
