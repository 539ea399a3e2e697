/** The playground for the tests, and the program that it is compared with. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import type { Browser } from "playwright-core";
import { open, type Opened } from "./browser";

/** Path of the page. */
export const page = process.env["PLAYGROUND"] ?? "";
const feeler = process.env["FEELER"] ?? "";
export const skip = page && feeler ? false : "needs PLAYGROUND and FEELER";

export const url = (hash = "") => pathToFileURL(page).href + hash;

/** Opens the playground in `browser` and waits until it is ready. */
export async function opened(browser: Browser, hash = "", options = {}): Promise<Opened> {
  const result = await open(browser, url(hash), options);
  await result.page.waitForFunction(() => "feeler" in window);
  return result;
}

/** Asserts that there are no errors and that only the page's own parts were loaded. */
export function nothingElse({ errors, requests }: Opened): void {
  assert.deepEqual(errors, []);
  assert.deepEqual(
    requests.filter((url) => !/^(blob:|about:|file:.*playground\.html)/.test(url)),
    [],
  );
}

export const folder = () => mkdtempSync(join(tmpdir(), "feeler-playground-"));

/** Runs the program in the folder `cwd` and returns its standard output. */
export function program(cwd: string, ...words: string[]): string {
  return execFileSync(feeler, words, { cwd, encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] });
}

/** Digest of the program's run with `settings` of the form `KEY=VALUE`. */
export function digestOf(experiment: string, sensing: string, settings: string[] = []): string {
  const out = folder();
  const set = settings.flatMap((setting) => ["--set", setting]);
  try {
    program(out, "run", experiment, "--sensing", sensing, ...set, "--out", "run");
  } catch {
    // A run whose task fails has a digest, too.
  }
  return JSON.parse(readFileSync(join(out, "run", "summary.json"), "utf8")).digest;
}

/** Names of the built-in experiments. */
export function experiments(): string[] {
  const own = program(".", "list").split("\n\n")[0] ?? "";
  return own.split("\n").map((line) => line.split(" ")[0] ?? "");
}

/**
 * A simulated fingertip: returns a folder with `loads/untouched.png`, `loads/LOADS.csv` and its images, `layout.toml`
 * and `calibration.toml`.
 */
export function simulatedFingertip(): string {
  const out = folder();
  program(out, "calibrate", "--simulated", "--loads", "60", "--write-loads", "loads", "-o", "reference.toml");
  program(out, "locate", "loads/untouched.png", "-o", "layout.toml");
  program(out, "calibrate", "loads/LOADS.csv", "--layout", "layout.toml", "-o", "calibration.toml");
  return out;
}
