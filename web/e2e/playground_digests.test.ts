/**
 * Runs have the same digest in the playground as in the program. `PLAYGROUND` is the path of the page, `FEELER` that of the
 * program. `IMAGE_SECONDS` limits the simulated time of runs with images (s).
 */
import assert from "node:assert/strict";
import { test } from "node:test";
import { launch } from "./browser";
import { digestOf, experiments, nothingElse, opened, skip } from "./playground_page";

test("every built-in experiment has the digest of the program", { skip }, async (context) => {
  const browser = await launch();
  context.after(() => browser.close());
  const result = await opened(browser);
  const names = experiments();
  assert.ok(names.length >= 14, String(names));
  for (const experiment of names) {
    for (const sensing of ["direct", "image"] as const) {
      const limit = sensing === "image" && process.env["IMAGE_SECONDS"];
      const set = limit ? [`time_limit=${limit}`] : [];
      const order = { experiment, sensing, set };
      const { digest } = await result.page.evaluate((order) => window.feeler.run(order), order);
      assert.equal(digest, digestOf(experiment, sensing, set), `${experiment} ${sensing}`);
    }
  }
  nothingElse(result);
});
