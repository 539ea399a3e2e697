/** Rumble and tone of the live page, with a gamepad and a clock of the test, and the browser's own Web Audio. */
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import type { Browser, Page } from "playwright-core";
import { feel } from "../src/feel/mapping";
import type { LiveFelt } from "../src/page_data";
import { launch, open, type Opened, until } from "./browser";
import { type Effect, felt, mock } from "./felt";
import { type Rig, startRig } from "./live_server";

let browser: Browser;
let rig: Rig;
before(async () => {
  browser = await launch(["--autoplay-policy=document-user-activation-required"]);
  rig = await startRig();
});
after(async () => {
  await browser.close();
  await rig.close();
});

const toggle = (page: Page) => page.getByRole("checkbox", { name: "Rumble and tone" });
const status = (page: Page, text: RegExp) => page.locator(".feel-status").getByText(text).waitFor();
const reports = () => rig.orders.map((order) => (JSON.parse(order) as LiveFelt).felt);
const report = () => until(async () => rig.orders.length > 0, "a report arrives");

let time = 0;
/** Sends a row in which finger 0 grips with 1 N and finger 1 slips. */
function send(): number {
  const row = rig.rows[0];
  assert.ok(row);
  rig.send({ ...row, time: ++time, graspForce: [1, 0.4], flags: [1, 3], shearRate: [2, 10] });
  return time;
}

async function openPage(prepare: (page: Page) => Promise<void> = mock): Promise<Opened> {
  for (const context of browser.contexts()) await context.close();
  await until(async () => rig.sockets() === 0, "earlier pages disconnect");
  rig.orders.length = 0;
  const opened = await open(browser, rig.url, {}, prepare);
  await until(async () => rig.sockets() === 1, "the page connects");
  return opened;
}

async function close({ page, errors }: Opened): Promise<void> {
  assert.deepEqual(errors, []);
  await page.context().close();
}

/** Sends a row and waits until the page has played it. */
async function play(page: Page): Promise<Effect> {
  const count = (await felt(page)).effects.length;
  send();
  await until(async () => (await felt(page)).effects.length > count, "an effect");
  return (await felt(page)).effects[count] as Effect;
}

test("nothing is played until it is switched on, which is remembered", async () => {
  const opened = await openPage();
  const { page } = opened;
  const last = send();
  await until(
    async () => (await page.locator(".player-time").innerText()).startsWith(`${last}.00`),
    "the row",
  );
  assert.equal(await toggle(page).isChecked(), false);
  assert.deepEqual(await felt(page), { effects: [], resets: 0, contexts: 0 });
  assert.deepEqual(rig.orders, []);
  // By keyboard only.
  await page.keyboard.press("f");
  await status(page, /Tone on. Rumble on test pad/);
  await page.getByLabel("Finger to feel").selectOption("finger 1");
  await page.getByLabel("Grasp force at full strength").selectOption("5 N");
  await page.reload();
  assert.ok(await toggle(page).isChecked());
  assert.equal(await page.getByLabel("Finger to feel").inputValue(), "1");
  assert.equal(await page.getByLabel("Grasp force at full strength").inputValue(), "5");
  // A browser permits no sound before the first click or key.
  await status(page, /starts after a click or key/);
  assert.equal((await felt(page)).contexts, 0);
  await page.keyboard.press("Shift+a");
  await status(page, /Tone on/);
  await close(opened);
});

test("grip and slip are played and reported", async () => {
  const opened = await openPage();
  const { page } = opened;
  await toggle(page).check();
  await status(page, /Tone on/);
  const slipping = feel({ force: 0.4, touch: true, slip: true, shearRate: 10 }, 2, 0);
  const effect = await play(page);
  assert.ok(Math.abs(effect.strong - slipping.strong) < 1e-6 && Math.abs(effect.weak - slipping.weak) < 1e-6);
  await until(async () => reports().length > 0, "a report");
  const [first] = reports();
  assert.equal(first?.time, time);
  assert.ok(Math.abs((first?.frequency ?? 0) - slipping.frequency) < 1e-3);
  assert.ok(Math.abs((first?.gain ?? 0) - slipping.gain) < 1e-6);
  await page.getByLabel("Finger to feel").selectOption("finger 0");
  const gripping = await play(page);
  assert.deepEqual([gripping.strong, gripping.weak], [0.5, 0]);
  await close(opened);
});

test("the rumble of stale data fades and ends within 100 ms", async () => {
  const opened = await openPage(async (page) => {
    await page.clock.install({ time: 0 });
    await mock(page);
  });
  const { page } = opened;
  await toggle(page).check();
  await page.clock.pauseAt(60_000);
  const fresh = await play(page);
  await page.clock.runFor(300);
  const { effects, resets } = await felt(page);
  const after = effects.filter(({ start }) => start > fresh.start);
  assert.ok(after.length > 0 && resets > 0);
  let weak = fresh.weak;
  for (const effect of [fresh, ...after]) {
    assert.ok(effect.start + effect.duration - fresh.start <= 100, JSON.stringify(effect));
    assert.ok(effect.weak <= weak);
    weak = effect.weak;
  }
  // The last report is silence, while the tone is still on.
  await until(async () => reports().at(-1)?.weak === 0, "the last report");
  assert.deepEqual([reports().at(-1)?.strong, reports().at(-1)?.gain], [0, 0]);
  await close(opened);
});

test("the tone of stale data fades and ends within 100 ms on the audio clock, even if the page hangs", async () => {
  const opened = await openPage((page) => mock(page, { isOffline: true }));
  const { page } = opened;
  await toggle(page).check();
  await play(page);
  const { gain, frequency } = feel({ force: 0.4, touch: true, slip: true, shearRate: 10 }, 2, 0);
  // The context renders the schedule of a single row; no timer of the page takes part.
  const { sound, rate } = await page.evaluate(() =>
    (window as unknown as { render: () => Promise<{ sound: number[]; rate: number }> }).render(),
  );
  const part = (from: number, to: number) => sound.slice((from * rate) / 1000, (to * rate) / 1000);
  const peak = (part: number[]) => Math.max(...part.map(Math.abs));
  const middle = part(20, 60);
  assert.ok(Math.abs(peak(middle) / gain - 1) < 0.01, `${peak(middle)}`);
  const crossings = middle.filter((value, i) => i > 0 && value >= 0 && (middle[i - 1] ?? 0) < 0).length;
  assert.ok(Math.abs(crossings / 0.04 - frequency) <= 25, `${crossings / 0.04} Hz`);
  assert.ok(peak(part(75, 90)) < 0.55 * gain);
  assert.equal(peak(part(91, 1000)), 0);
  await close(opened);
});

test("the tone is audible in real time and falls silent", async () => {
  const opened = await openPage();
  const { page } = opened;
  await toggle(page).check();
  await status(page, /Tone on/);
  const loudness = () => page.evaluate(() => (window as unknown as { loudness: () => number }).loudness());
  const sending = setInterval(send, 33);
  await until(async () => (await loudness()) > 0.05, "a tone").finally(() => clearInterval(sending));
  await until(async () => (await loudness()) === 0, "silence");
  await close(opened);
});

test("a hidden page plays nothing", async () => {
  const opened = await openPage();
  const { page } = opened;
  await toggle(page).check();
  await status(page, /Tone on/);
  await play(page);
  const hide = (hidden: boolean) =>
    page.evaluate((hidden) => {
      Object.defineProperty(document, "hidden", { configurable: true, get: () => hidden });
      document.dispatchEvent(new Event("visibilitychange"));
    }, hidden);
  await hide(true);
  await status(page, /starts after/);
  const { resets, effects } = await felt(page);
  assert.ok(resets > 0);
  await until(async () => reports().at(-1)?.weak === 0, "a report of silence");
  const last = send();
  await until(
    async () => (await page.locator(".player-time").innerText()).startsWith(`${last}.00`),
    "the row",
  );
  assert.equal((await felt(page)).effects.length, effects.length);
  await hide(false);
  await status(page, /Tone on/);
  await play(page);
  await close(opened);
});

test("an unplugged gamepad and one without rumble are reported", async () => {
  const opened = await openPage();
  const { page } = opened;
  await toggle(page).check();
  await play(page);
  const plug = (kind: string) =>
    page.evaluate((kind) => (window as unknown as { plug: (kind: string) => void }).plug(kind), kind);
  await plug("none");
  await status(page, /No gamepad: connect one/);
  rig.orders.length = 0;
  send();
  await report();
  // The tone is still played; the rumble is not, and is not reported.
  assert.deepEqual([reports()[0]?.strong, reports()[0]?.weak], [0, 0]);
  await plug("plain");
  await status(page, /The gamepad test pad has no rumble/);
  await plug("broken");
  send();
  await status(page, /does not rumble: out of order/);
  await plug("good");
  await play(page);
  await status(page, /Rumble on test pad/);
  await close(opened);
});

test("a browser without rumble is reported", async () => {
  const opened = await openPage((page) => mock(page, { lacksRumble: true }));
  const { page } = opened;
  await toggle(page).check();
  await status(page, /This browser does not support the rumble of gamepads/);
  send();
  await report();
  await close(opened);
});

test("the end of the run ends rumble and tone", async () => {
  const opened = await openPage();
  const { page } = opened;
  await toggle(page).check();
  await play(page);
  rig.state({ state: "Done.", stopped: false, over: true });
  await status(page, /The run has ended/);
  assert.ok((await felt(page)).resets > 0);
  const { effects } = await felt(page);
  const last = send();
  await until(
    async () => (await page.locator(".player-time").innerText()).startsWith(`${last}.00`),
    "the row",
  );
  assert.equal((await felt(page)).effects.length, effects.length);
  await close(opened);
});
