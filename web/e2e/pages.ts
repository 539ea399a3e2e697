/** The pages under test: samples made here, and those of the folder REPORTS. */
import { mkdtempSync, readdirSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { reportPage } from "../sample/document";
import { reportData } from "../sample/page_data";
import { simulate } from "../sample/simulate";

export const run = simulate(4);
export const data = reportData(run);

const folder = mkdtempSync(join(tmpdir(), "feeler-e2e-"));

/** Writes a page, and returns its address. */
export function write(name: string, text: string): string {
  const file = join(folder, name);
  writeFileSync(file, text);
  return pathToFileURL(file).href;
}

export const sample = write("sample.html", reportPage(data));

/** The sample and the reports that somebody made. */
export function allPages(): string[] {
  const reports = process.env["REPORTS"];
  if (!reports) return [sample];
  const names = readdirSync(reports).filter((name) => name.endsWith(".html"));
  return [sample, ...names.map((name) => pathToFileURL(resolve(reports, name)).href)];
}
