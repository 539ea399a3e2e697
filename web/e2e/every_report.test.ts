/** Requirements for all reports. Rust tests check that a page's columns match the recording. */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import type { Browser, Page } from "playwright-core";
import { moment, quantity } from "../src/format";
import type { PageData } from "../src/page_data";
import type { Table } from "../src/table";
import { eventually, launch, open } from "./browser";
import { allPages } from "./pages";
import { recorded } from "./recorded";

let browser: Browser;
before(async () => {
  browser = await launch();
});
after(() => browser.close());

/** Fractions of a run at which the fingers move in every task. */
const PLACES = [0.35, 0.62, 0.9];

async function seek(page: Page, table: Table, row: number): Promise<void> {
  await page.locator(".player input").fill(String(row));
  await page
    .getByText(moment(table.time(row)), { exact: true })
    .first()
    .waitFor();
  // The row is drawn in the next animation frame.
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
}

/** Expected legend values of all figures at a row, by the figure's selector. */
function expected({ figures }: PageData, table: Table, row: number): Map<string, string[]> {
  const values = figures.map(({ number, panels }): [string, string[]] => {
    const ofTime = panels.filter((panel) => panel.kind === "time");
    const read = ofTime.flatMap(({ series, y }) =>
      series.map(({ column, line }) => {
        if (!column || line === "states") return "";
        return quantity(table.column(column.name)?.at(row, column.index) ?? NaN, y.unit, y.scale);
      }),
    );
    return [`#fig-${String(number).padStart(2, "0")}`, read];
  });
  return new Map(values.filter(([, read]) => read.some(Boolean)));
}

const reports = allPages().filter((url) => url.endsWith("/report.html"));
// Without any test, this file would wait forever for its browser.
if (reports.length === 0) test("reports", { skip: "REPORTS is not set to a folder with reports of feeler" });

for (const url of reports) {
  const name = url.split("/").slice(-2).join("/");

  test(`${name}: the scene moves, and values at the cursor match the run`, async () => {
    const { page, errors } = await open(browser, url);
    await page.locator(".player").waitFor();
    const { data, table } = await recorded(readFileSync(fileURLToPath(url), "utf8"));
    const scene = page.locator(".scene-canvas canvas");
    const pictures: Buffer[] = [];
    for (const place of PLACES) {
      const row = Math.round(place * (table.length - 1));
      await page.locator("#scene").scrollIntoViewIfNeeded();
      await seek(page, table, row);
      pictures.push(await scene.screenshot());
      for (const [figure, values] of expected(data, table, row)) {
        await page.locator(figure).scrollIntoViewIfNeeded();
        // A figure is updated only while it is visible.
        const shown = async () =>
          (await page.locator(`${figure} .legend-value`).allInnerTexts()).filter((_, i) => values[i]);
        await eventually(shown, values.filter(Boolean), `${figure}, row ${row}`);
      }
    }
    for (const [i, picture] of pictures.entries()) {
      assert.ok(!picture.equals(pictures[(i + 1) % pictures.length] ?? picture), "the scene changes");
    }
    assert.deepEqual(errors, []);
    await page.context().close();
  });
}
