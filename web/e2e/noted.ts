/** Records, within a live page and with its clock, the messages that it receives and the flags that it shows. */
import type { Page } from "playwright-core";

export interface Row {
  /** Time of the row (s). */
  time: number;
  /** Time of arrival (ms). */
  at: number;
}

/** A change of a flag. */
export interface Change {
  /** Row that caused the change. */
  row: Row;
  finger: number;
  name: string;
  on: boolean;
  /** Time at which the page showed the change (ms). */
  at: number;
}

export interface Noted {
  rows: Row[];
  changes: Change[];
  /** Times at which the stop button was pressed (ms). */
  stops: number[];
}

/** Starts recording as soon as `page` loads a document. */
export async function note(page: Page): Promise<void> {
  await page.addInitScript(() => {
    const noted: Noted = { rows: [], changes: [], stops: [] };
    Object.assign(window, { noted });
    // The page adds its own listener after this one.
    window.WebSocket = class extends WebSocket {
      constructor(url: string | URL, protocols?: string | string[]) {
        super(url, protocols);
        this.addEventListener("message", ({ data }) => {
          if (!(data instanceof ArrayBuffer)) return;
          noted.rows.push({ time: new DataView(data).getFloat64(0, true), at: Date.now() });
        });
      }
    };
    // Called at the end of the task in which the page shows a row.
    const observer = new MutationObserver((records) => {
      const at = Date.now();
      for (const { target, oldValue } of records) {
        const chip = target as Element;
        if (!chip.classList.contains("chip")) continue;
        const on = chip.classList.contains("on");
        if (on === / on( |$)/.test(oldValue ?? "")) continue;
        const fingers = [...document.querySelectorAll(".live-finger")];
        const finger = fingers.findIndex((finger) => finger.contains(chip));
        // Skips the chips of the fingertip panels, which are updated in the next animation frame.
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
