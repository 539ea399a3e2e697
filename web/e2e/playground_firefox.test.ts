/** The playground in Firefox. */
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Firefox } from "./firefox";
import { until } from "./browser";
import { digestOf, simulatedFingertip, skip, url } from "./playground_page";

let firefox: Firefox;
before(async () => {
  if (skip) return;
  firefox = await Firefox.open(url(), 390, 800);
  await until(() => firefox.evaluate(`"feeler" in window`), "the page is ready");
});
after(() => {
  if (!skip) firefox.close();
});

test("runs have the digests of the program", { skip }, async () => {
  for (const [experiment, sensing] of [
    ["cap-closing", "direct"],
    ["cap-closing", "image"],
    ["lift", "direct"],
  ] as const) {
    const run = JSON.stringify({ experiment, sensing });
    const { digest } = await firefox.evaluate<{ digest: string }>(`window.feeler.run(${run})`);
    assert.equal(digest, digestOf(experiment, sensing), `${experiment} ${sensing}`);
  }
});

test("a run is shown and ends with its result, without scrolling sideways", { skip }, async () => {
  await firefox.evaluate(`(document.querySelector("#speed").value = "Infinity",
    document.querySelector("button.primary").click())`);
  await until(() => firefox.evaluate(`document.querySelector(".result .digest") !== null`), "a result");
  const width = await firefox.evaluate<number>(`document.documentElement.scrollWidth`);
  assert.ok(width <= 390, `${width} px`);
});

test("markers of an image are located", { skip }, async () => {
  await firefox.setFiles("#fingertip", [`${simulatedFingertip()}/loads/untouched.png`]);
  await until(() => firefox.evaluate(`document.body.textContent.includes("41 markers.")`), "41 markers");
});

test("there are no errors", { skip }, () => {
  assert.deepEqual(firefox.errors, []);
});
