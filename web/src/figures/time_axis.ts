/** Time axis shared by the panels of a figure. */
import type uPlot from "uplot";
import type { Table } from "../table";

/** Minimum number of visible rows. */
const LEAST_ROWS = 5;

export class TimeAxis {
  readonly #table: Table;
  readonly #rows: [number, number] | undefined;
  readonly #plots: uPlot[] = [];
  #zoomed = false;

  /** Initially shows `rows`, or all rows if undefined. */
  constructor(table: Table, rows: [number, number] | undefined) {
    this.#table = table;
    this.#rows = rows;
  }

  add(plot: uPlot): void {
    this.#plots.push(plot);
    this.reset();
  }

  show(from: number, to: number): void {
    this.#zoomed = true;
    this.#set(from, to);
  }

  reset(): void {
    this.#zoomed = false;
    const last = Math.max(0, this.#table.length - 1);
    const [start, end] = this.#rows ?? [0, last];
    this.#set(this.#table.time(start), this.#table.time(Math.min(end, last)));
  }

  /** Shows new rows unless the reader has zoomed. */
  follow(): void {
    if (!this.#zoomed) this.reset();
  }

  /** Moves and scales the axis so that the times under two fingers stay under them. */
  pinch(plot: uPlot, from: [number, number], to: [number, number]): void {
    const width = plot.over.clientWidth;
    const pixels = to[1] - to[0];
    if (Math.abs(pixels) < 8) return;
    const [a, b] = [plot.posToVal(from[0], "x"), plot.posToVal(from[1], "x")];
    const perPixel = (b - a) / pixels;
    if (perPixel > 0) this.show(a - to[0] * perPixel, a + (width - to[0]) * perPixel);
  }

  #set(from: number, to: number): void {
    const last = this.#table.length - 1;
    const [first, end] = [this.#table.time(0), this.#table.time(last)];
    const least = (LEAST_ROWS * (end - first)) / Math.max(1, last);
    const [min, max] = [Math.max(from, first), Math.min(to, end)];
    if (!(max > min && max - min >= 0.99 * Math.min(least, end - first))) return;
    for (const plot of this.#plots) plot.setScale("x", { min, max });
  }
}
