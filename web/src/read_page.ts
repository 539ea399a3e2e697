/** Parses and validates the page's data. */
import type { PageData, Scene } from "./page_data";
import { PageProblem } from "./problem";

/** Supported version of the page data. */
const VERSION = 1;

export function readPage(text: string): PageData {
  let page: PageData;
  try {
    page = JSON.parse(text);
  } catch {
    throw new PageProblem("This page's data are damaged: they are not valid JSON.");
  }
  if (typeof page !== "object" || page === null) throw new PageProblem("This page contains no data.");
  if (page.version !== VERSION) {
    throw new PageProblem(
      `This page's data have version ${page.version}; its script requires version ${VERSION}. Generate the page again.`,
    );
  }
  if (!Array.isArray(page.figures)) throw new PageProblem("This page's data lack “figures”.");
  if (page.run) checkRun(page.run);
  if (page.scene) checkScene(page.scene);
  return page;
}

function checkRun(run: NonNullable<PageData["run"]>): void {
  for (const field of ["columns", "phases", "strokes"] as const) {
    if (!Array.isArray(run[field])) throw new PageProblem(`The run's data lack “${field}”.`);
  }
  if (!Number.isInteger(run.rows) || run.rows < 0 || typeof run.data !== "string") {
    throw new PageProblem("The run's data lack “rows” or “data”.");
  }
  for (const { name, width, scale } of run.columns) {
    if (!Number.isInteger(width) || width < 1 || !Number.isFinite(scale)) {
      throw new PageProblem(`Column “${name}” has an invalid width or scale.`);
    }
  }
}

function checkScene(scene: Scene): void {
  for (const field of ["frames", "shapes", "fingers"] as const) {
    if (!Array.isArray(scene[field])) throw new PageProblem(`The scene lacks “${field}”.`);
  }
  if (!scene.home) throw new PageProblem("The scene lacks “home”.");
}
