/** A browser for the tests, and what its pages said. */
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
  // Of what is drawn without a graphics card only WebGL needs one that is emulated: the page is put together faster without.
  "--disable-gpu-compositing",
];

/** What the browser says of itself where it takes pictures of WebGL back to put the page together. */
const OWN_WARNING = "GPU stall due to ReadPixels";

/** How long a test waits for what must happen, ms. */
const PATIENCE = 180_000;
/** How often it looks, ms. */
const INTERVAL = 50;

export function launch(flags: string[] = []): Promise<Browser> {
  const executablePath = process.env["CHROMIUM"] ?? execSync("command -v chromium").toString().trim();
  return chromium.launch({ executablePath, args: [...FLAGS, ...flags] });
}

export interface Opened {
  page: Page;
  /** Errors of the console and of scripts. */
  errors: string[];
  /** Addresses that the page asked for, besides itself. */
  requests: string[];
}

/** Opens the page at `url`, once it is prepared. */
export async function open(
  browser: Browser,
  url: string,
  options: BrowserContextOptions = {},
  prepare: (page: Page) => Promise<void> = async () => {},
): Promise<Opened> {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  // No test fails because the computer is busy.
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

/** How soon a live page must show a flag, ms. */
const FLAG_LATENCY = 100;

/** Tells a latency, ms, and holds it where asked to (`LATENCY=1`), as a busy computer has no say in what is right. */
export function holdLatency(told: string, latency: number): void {
  console.log(told);
  if (process.env["LATENCY"]) assert.ok(latency < FLAG_LATENCY, told);
}

/** Whether `what` is so within the time that a test waits. */
async function comesTrue(what: () => Promise<boolean>): Promise<boolean> {
  for (let waited = 0; waited < PATIENCE; waited += INTERVAL) {
    if (await what()) return true;
    await new Promise((resolve) => setTimeout(resolve, INTERVAL));
  }
  return false;
}

/** Waits until `what` is so; `message` says what that is. */
export async function until(what: () => Promise<boolean>, message: string): Promise<void> {
  if (!(await comesTrue(what))) throw new Error(`not within ${PATIENCE / 1000} s: ${message}`);
}

/** Waits until `read` gives what is expected; `message` says of what. */
export async function eventually<T>(read: () => Promise<T>, expected: T, message: string): Promise<void> {
  let actual: T | undefined;
  await comesTrue(async () => isDeepStrictEqual((actual = await read()), expected));
  assert.deepEqual(actual, expected, message);
}
