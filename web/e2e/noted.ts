/** What a live page gets and shows, noted within the page by its own clock. */
import type { Page } from "playwright-core";

export interface Row {
  /** Its time, s. */
  time: number;
  /** When it came, ms. */
  at: number;
}

/** A flag that changed. */
export interface Change {
  /** The row that changed it. */
  row: Row;
  finger: number;
  name: string;
  on: boolean;
  /** When the page showed it, ms. */
  at: number;
}

export interface Noted {
  rows: Row[];
  changes: Change[];
  /** When the stop button was pressed, ms. */
  stops: number[];
}

/** Has pages of `page` note from their beginning on. */
export async function note(page: Page): Promise<void> {
  await page.addInitScript(() => {
    const noted: Noted = { rows: [], changes: [], stops: [] };
    Object.assign(window, { noted });
    // The page's own listener comes after this one.
    window.WebSocket = class extends WebSocket {
      constructor(url: string | URL, protocols?: string | string[]) {
        super(url, protocols);
        this.addEventListener("message", ({ data }) => {
          if (!(data instanceof ArrayBuffer)) return;
          noted.rows.push({ time: new DataView(data).getFloat64(0, true), at: Date.now() });
        });
      }
    };
    // It is called at the end of the task in which the page shows a row.
    const observer = new MutationObserver((records) => {
      const at = Date.now();
      for (const { target, oldValue } of records) {
        const chip = target as Element;
        if (!chip.classList.contains("chip")) continue;
        const on = chip.classList.contains("on");
        if (on === / on( |$)/.test(oldValue ?? "")) continue;
        const fingers = [...document.querySelectorAll(".live-finger")];
        const finger = fingers.findIndex((finger) => finger.contains(chip));
        // The pictures of the fingertips have chips, too, which are drawn with the next frame.
        if (finger < 0) continue;
        const row = noted.rows.at(-1) ?? { time: NaN, at: NaN };
        noted.changes.push({ row, finger, name: chip.textContent ?? "", on, at });
      }
    });
    observer.observe(document, { subtree: true, attributeFilter: ["class"], attributeOldValue: true });
    const pressed = ({ target }: Event) => {
      if ((target as Element).closest("button.stop")) noted.stops.push(Date.now());
    };
    document.addEventListener("click", pressed, { capture: true });
  });
}

export const noted = (page: Page): Promise<Noted> =>
  page.evaluate(() => (window as unknown as { noted: Noted }).noted);
