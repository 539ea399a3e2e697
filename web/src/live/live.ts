/** A live page: receives rows, shows flags and state at once, and sends orders. */
import { Feel } from "../feel/feel";
import type { Live } from "../page_data";
import type { Playback } from "../playback";
import { PageProblem } from "../problem";
import type { FingerColumns } from "../run";
import { Connection } from "./connection";
import { readState } from "./messages";
import { LivePanel } from "./panel";
import type { Ring } from "./ring";

/** Rows older than this are reported as stale (ms). */
const STALE = 1000;
/** Interval of the check for stale rows (ms). */
const WATCH = 250;

export class LivePage {
  readonly panel: LivePanel;
  readonly feel: Feel;
  readonly #ring: Ring;
  readonly #playback: Playback;
  readonly #fingers: FingerColumns[];
  readonly #rowsGone: () => void;
  readonly #connection: Connection;
  #connected = false;
  #over = false;
  #lastRow = performance.now();
  /** Error in the last message, if any. */
  #problem = "";

  /** Calls `rowsGone` when the oldest rows have been removed. */
  constructor(live: Live, ring: Ring, playback: Playback, fingers: FingerColumns[], rowsGone: () => void) {
    this.#ring = ring;
    this.#playback = playback;
    this.#fingers = fingers;
    this.#rowsGone = rowsGone;
    this.panel = new LivePanel(fingers, live.orders, (order) => this.order(order));
    this.feel = new Feel(fingers, (felt) => live.felt && this.#connection.send({ felt }));
    this.panel.element.append(this.feel.panel.element);
    this.#connection = new Connection(live.socket, {
      row: (message) => this.#read(() => this.#row(message)),
      state: (text) => this.#read(() => this.#state(text)),
      connected: (there) => this.#connectionChanged(there),
    });
    setInterval(() => this.#watch(), WATCH);
  }

  order(order: "stop" | "resume"): void {
    if (this.#connection.send({ order })) return;
    this.panel.notice(`Not connected: “${order}” was not sent. Use the stop of the hand itself.`);
  }

  /** An unreadable message is reported and otherwise ignored. */
  #read(message: () => void): void {
    try {
      message();
      this.#problem = "";
    } catch (error) {
      if (!(error instanceof PageProblem)) throw error;
      this.#problem = error.message;
    }
    this.#watch();
  }

  #row(message: ArrayBuffer): void {
    const gone = this.#ring.add(message);
    this.#lastRow = performance.now();
    if (gone > 0) {
      this.#playback.shift(gone);
      this.#rowsGone();
    }
    const row = this.#ring.table.length - 1;
    this.#fingers.forEach((finger, i) => this.panel.showFlags(i, finger.flags(row)));
    this.feel.row(row, this.#ring.table.time(row));
    this.#playback.request();
  }

  #state(text: string): void {
    const state = readState(text);
    this.#over = state.over;
    if (state.over) {
      this.#connection.end();
      this.feel.end();
    }
    this.panel.showState(state);
  }

  #connectionChanged(there: boolean): void {
    this.#connected = there;
    this.#lastRow = performance.now();
    this.panel.connected(there);
    this.#watch();
  }

  #watch(): void {
    this.panel.notice(this.#problem || this.#trouble());
  }

  #trouble(): string {
    if (this.#over) return "";
    if (!this.#connected) return "Connection lost; the page shows old data. Reconnecting …";
    const age = performance.now() - this.#lastRow;
    if (age < STALE) return "";
    return `No data for ${Math.floor(age / 1000)} s; the page shows old data.`;
  }
}
