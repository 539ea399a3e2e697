/** Ring buffer with the latest rows of a live page, in constant memory. */
import type { Column as Description } from "../page_data";
import { PageProblem } from "../problem";
import { Column, Table } from "../table";

export class Ring {
  readonly table: Table;
  readonly #keep: number;
  readonly #columns: Column[];
  readonly #message: number;

  /** Keeps at least `keep` rows. The capacity is twice that number, so that rows are rarely moved. */
  constructor(descriptions: Description[], keep: number) {
    this.#keep = Math.max(2, keep);
    this.#columns = descriptions.map(({ name, width }) => {
      const numbers = 2 * this.#keep * width;
      return new Column(
        name,
        width,
        name === "time" ? new Float64Array(numbers) : new Float32Array(numbers),
        1,
      );
    });
    this.table = new Table(this.#columns, 0);
    this.#message = this.#columns.reduce(
      (bytes, { name, width }) => bytes + width * (name === "time" ? 8 : 4),
      0,
    );
  }

  /** Adds the row of a message. Returns the number of removed old rows. */
  add(buffer: ArrayBuffer): number {
    if (buffer.byteLength !== this.#message) {
      throw new PageProblem(
        `Invalid row: expected ${this.#message} bytes, got ${buffer.byteLength} bytes. Reload the page.`,
      );
    }
    const message = new DataView(buffer);
    const time = message.getFloat64(0, true);
    const gone = this.#makeRoom(time);
    const row = this.table.length++;
    let place = 8;
    for (const { name, width, stored } of this.#columns) {
      if (name === "time") {
        stored[row] = time;
        continue;
      }
      for (let k = 0; k < width; k++, place += 4) stored[row * width + k] = message.getFloat32(place, true);
    }
    return gone;
  }

  #makeRoom(time: number): number {
    const { length } = this.table;
    // Time that does not increase belongs to a new run.
    if (length > 0 && time <= this.table.time(length - 1)) return this.#drop(length);
    return length >= 2 * this.#keep ? this.#drop(length - this.#keep) : 0;
  }

  #drop(rows: number): number {
    for (const { width, stored } of this.#columns)
      stored.copyWithin(0, rows * width, this.table.length * width);
    this.table.length -= rows;
    return rows;
  }
}
