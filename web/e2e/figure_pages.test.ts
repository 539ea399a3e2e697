/** Pages with only figures, which feeler makes from many trials: sweep, comparison, slip detectors. */
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import type { Browser, Page } from "playwright-core";
import { significant } from "../src/format";
import { launch, open } from "./browser";
import { made } from "./pages";

const SWEEP = made("sweep/summary.html");
const COMPARISON = made("comparison/compare.html");
const SLIP = made("slip/slip.html");
/** Program that made the pages. */
const FEELER = process.env["FEELER"] ?? "feeler";
const skip = SWEEP ? false : "REPORTS is not set to a folder of pages that feeler made";

let browser: Browser;
before(async () => {
  browser = await launch();
});
after(() => browser.close());

/** Moves the mouse over a panel until a tooltip matches all patterns. Returns the lines of the tooltip. */
async function findPoint(page: Page, figure: string, panel: number, wanted: RegExp[]): Promise<string[]> {
  const over = page.locator(`${figure} .u-over`).nth(panel);
  await over.scrollIntoViewIfNeeded();
  const box = await over.boundingBox();
  assert.ok(box);
  const tooltip = over.locator(".tooltip");
  for (let y = 0.02; y < 1; y += 0.06) {
    for (let x = 0.02; x < 1; x += 0.04) {
      await over.hover({ position: { x: x * box.width, y: y * box.height } });
      if (!(await tooltip.isVisible())) continue;
      const text = await tooltip.innerText();
      if (wanted.every((part) => part.test(text))) return text.split("\n").filter(Boolean);
    }
  }
  return assert.fail(`no tooltip of ${figure} matches ${wanted.join(", ")}`);
}

/** Runs a command as displayed and returns the summary of its run. */
function runAgain(command: string) {
  const out = join(mkdtempSync(join(tmpdir(), "feeler-trial-")), "run");
  const quoted = command.replace(/^feeler /, `'${FEELER}' `);
  // A run with a failed task has exit status 1 and still writes a summary.
  execFileSync("sh", ["-c", `${quoted} --out '${out}' || [ $? = 1 ]`], { stdio: "pipe" });
  return JSON.parse(readFileSync(join(out, "summary.json"), "utf8"));
}

/** Row of a trial in the page's `trials.csv`. */
function rowOf(folder: string, trial: string): Record<string, string> {
  const lines = readFileSync(join(folder, "trials.csv"), "utf8").trim().split("\n");
  const [header = [], ...rows] = lines.map((line) => line.split(","));
  const row = rows.find(([number]) => number === trial) ?? [];
  return Object.fromEntries(header.map((name, i) => [name, row[i] ?? ""]));
}

/** Checks that the tooltip, the table and a repeated run of the point's command agree. */
function holdsToItsTrial(lines: string[], told: string): void {
  const command = lines.find((line) => line.startsWith("feeler run --trial")) ?? "";
  const [folder = "", trial = ""] = command.split(" ").slice(3);
  const row = rowOf(folder, trial);
  assert.equal(told, `final torque: ${significant(1e3 * Number(row["cap_torque"]))}\u00a0mN·m`);
  const summary = runAgain(command);
  assert.equal(summary.final_torque, Number(row["stroke4.peak_torque"]));
}

async function commandOfPoint(url: string, figure: string, panel: number): Promise<string[]> {
  const { page, errors } = await open(browser, url);
  await page.locator(".uplot").first().waitFor();
  const lines = await findPoint(page, figure, panel, [/Click to copy/]);
  await page.mouse.down();
  await page.mouse.up();
  await page.getByText(/^(Copied|Copy failed; select the text here)$/).waitFor();
  assert.deepEqual(errors, []);
  await page.context().close();
  return lines;
}

test("a point of a sweep shows the command of its trial", { skip }, async () => {
  const lines = await commandOfPoint(SWEEP ?? "", "#fig-01", 1);
  holdsToItsTrial(lines, lines.find((line) => line.startsWith("final torque")) ?? "");
});

test("a point of a comparison shows the command of the trial under the other law", { skip }, async () => {
  const lines = await commandOfPoint(COMPARISON ?? "", "#fig-01", 0);
  const told = lines.find((line) => line.startsWith("best: final torque")) ?? "";
  holdsToItsTrial(lines, told.replace("best: ", ""));
});

test("tooltips show the detectors' operating points with intervals", { skip }, async () => {
  const { page, errors } = await open(browser, SLIP ?? "");
  await page.locator(".uplot").first().waitFor();
  const lines = await findPoint(page, "#fig-01", 0, [/missing shear above/, /precision/]);
  const table = await page.locator("tr", { hasText: /^missing shear\d/ }).innerText();
  const [, precision] = /precision ([\d.]+)/.exec(lines.join(" ")) ?? [];
  assert.ok(precision && table.includes(precision), `${lines.join(", ")}; ${table}`);
  assert.match(lines.join(" "), /slips detected: [\d.]+\u00a0% \[[\d.]+\u00a0%, [\d.]+\u00a0%\]/);
  assert.deepEqual(errors, []);
  await page.context().close();
});
