/** Pages under test: generated samples, and the pages in the folder REPORTS. */
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

/** Writes a page and returns its URL. */
export function write(name: string, text: string): string {
  const file = join(folder, name);
  writeFileSync(file, text);
  return pathToFileURL(file).href;
}

export const sample = write("sample.html", reportPage(data));

/** Folder REPORTS with pages made by feeler, if set. */
const reports = process.env["REPORTS"];

/** URLs of the sample and of the pages made by feeler. */
export function allPages(): string[] {
  if (!reports) return [sample];
  const names = readdirSync(reports, { recursive: true }).map(String);
  return [sample, ...names.filter((name) => name.endsWith(".html")).map((name) => address(reports, name))];
}

/** URL of a page made by feeler; undefined if REPORTS is not set. */
export const made = (name: string): string | undefined => reports && address(reports, name);

function address(folder: string, name: string): string {
  return pathToFileURL(resolve(folder, name)).href;
}
