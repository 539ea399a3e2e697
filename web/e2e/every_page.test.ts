/** Requirements for all kinds of pages. Set REPORTS to a folder to test its pages, too. */
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import type { Browser, Page } from "playwright-core";
import { launch, open } from "./browser";
import { allPages } from "./pages";

let browser: Browser;
before(async () => {
  browser = await launch();
});
after(() => browser.close());

const PHONE = { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true };

/**
 * Reports of other experiments are the same kind of page with other data. They are tested in a narrow window instead of
 * being opened again as on a phone.
 */
const REPORT = "cap-closing/report.html";
const isOneMore = (name: string) => name.endsWith("/report.html") && name !== REPORT;

const width = (page: Page) => page.evaluate(() => document.documentElement.scrollWidth);
const ground = (page: Page) => page.evaluate(() => getComputedStyle(document.body).backgroundColor);

const shown = (page: Page, selector: string) =>
  page.locator(selector).evaluateAll((all) => all.filter((e) => e.getClientRects().length > 0).length);

async function ready(page: Page): Promise<void> {
  await page.locator(".page-tools").waitFor();
}

// Opening a page takes a second or two, so checks that do not change the page share it.
for (const url of allPages()) {
  const name = url.split("/").slice(-2).join("/");

  test(name, async (t) => {
    const { page, errors, requests } = await open(browser, url);
    await ready(page);
    await page.waitForTimeout(1000);

    await t.test("opens without errors, requests or problems", async () => {
      assert.deepEqual(errors, []);
      assert.deepEqual(requests, []);
      assert.equal(await page.locator(".problem").count(), 0);
    });

    await t.test("gives canvases and controls accessible names", async () => {
      const nameless = await page.evaluate(() => {
        const canvases = [...document.querySelectorAll('canvas[role="img"]')].filter((c) => !c.ariaLabel);
        const controls = [...document.querySelectorAll("button, input, select")].filter(
          (c) => !c.ariaLabel && !c.textContent?.trim(),
        );
        return [...canvases, ...controls].map((element) => element.outerHTML);
      });
      assert.deepEqual(nameless, []);
    });

    await t.test("prints the static figures", async () => {
      const stills = await page.locator("figure > svg").count();
      await page.emulateMedia({ media: "print" });
      assert.equal(await shown(page, "figure > svg"), stills);
      assert.equal(await shown(page, ".panels, .player, .scene, .page-tools"), 0);
      const pdf = await page.pdf();
      assert.equal(pdf.subarray(0, 5).toString(), "%PDF-");
      assert.ok(pdf.length > 10_000);
      await page.emulateMedia({ media: "screen" });
    });

    if (isOneMore(name)) {
      await t.test(
        "does not scroll sideways in a narrow window, and follows the system's dark theme",
        async () => {
          const light = await ground(page);
          await page.emulateMedia({ colorScheme: "dark" });
          assert.notEqual(await ground(page), light);
          await page.setViewportSize(PHONE.viewport);
          await page.waitForTimeout(500);
          assert.ok((await width(page)) <= PHONE.viewport.width);
          assert.deepEqual(errors, []);
        },
      );
    }
    await page.context().close();
  });

  test(`${name} shows its static figures without scripts`, async () => {
    const { page } = await open(browser, url, { javaScriptEnabled: false });
    const stills = await page.locator("figure > svg").count();
    assert.equal(await shown(page, "figure > svg"), stills);
    await page.context().close();
  });

  if (isOneMore(name)) continue;

  test(`${name} on a phone with a dark theme`, async (t) => {
    const { page, errors } = await open(browser, url, { ...PHONE, colorScheme: "dark" });
    await ready(page);

    await t.test("does not scroll sideways", async () => {
      assert.ok((await width(page)) <= PHONE.viewport.width);
      assert.deepEqual(errors, []);
    });

    await t.test("is dark until the reader chooses light", async () => {
      const dark = await ground(page);
      await page.locator(".theme").click();
      assert.notEqual(await ground(page), dark);
      await page.reload();
      await ready(page);
      assert.notEqual(await ground(page), dark, "the choice is remembered");
    });
    await page.context().close();
  });
}
