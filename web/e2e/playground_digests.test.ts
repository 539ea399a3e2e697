/**
 * Runs have the same digest in the playground as in the program. `FEELER` is the path of the program, `PLAYGROUND` the
 * path of the page. If `FAST_PLAYGROUND` is the path of a page that was built with --fast, that page is compared instead,
 * of runs with images only the first 3 s.
 */
import assert from "node:assert/strict";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { launch, open } from "./browser";
import { digestOf, experiments, nothingElse } from "./playground_page";

const fast = process.env["FAST_PLAYGROUND"];
const page = fast ?? process.env["PLAYGROUND"];
const skip = page && process.env["FEELER"] ? false : "needs FEELER, and PLAYGROUND or FAST_PLAYGROUND";

test("every built-in experiment has the digest of the program", { skip }, async (context) => {
  const browser = await launch();
  context.after(() => browser.close());
  const result = await open(browser, pathToFileURL(page ?? "").href);
  await result.page.waitForFunction(() => "feeler" in window);
  const names = experiments();
  assert.ok(names.length >= 14, String(names));
  for (const experiment of names) {
    for (const sensing of ["direct", "image"] as const) {
      const set = fast && sensing === "image" ? ["time_limit=3"] : [];
      const order = { experiment, sensing, set };
      const { digest } = await result.page.evaluate((order) => window.feeler.run(order), order);
      assert.equal(digest, digestOf(experiment, sensing, set), `${experiment} ${sensing}`);
    }
  }
  nothingElse(result);
});
