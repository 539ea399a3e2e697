/** The rows of a run, as columns. */
import type { Column as Description, RunTable } from "./page_data";
import { PageProblem } from "./problem";

type Stored = Float64Array | Float32Array | Int16Array | Uint8Array;

/** Of these, the smallest stands for what is not known. */
const UNKNOWN_I16 = -32768;

export class Column {
  constructor(
    readonly name: string,
    readonly width: number,
    readonly stored: Stored,
    private readonly scale: number,
  ) {}

  /** The k-th number of a row in SI units; NaN where it is not known. */
  at(row: number, k = 0): number {
    const stored = this.stored[row * this.width + k];
    if (stored === undefined) return NaN;
    if (stored === UNKNOWN_I16 && this.stored instanceof Int16Array) return NaN;
    return stored * this.scale;
  }
}

export class Table {
  readonly #columns: Map<string, Column>;
  readonly #time: Column;

  constructor(
    columns: Column[],
    /** Rows that there are; what is stored beyond them is room. */
    public length: number,
  ) {
    this.#columns = new Map(columns.map((column) => [column.name, column]));
    const time = this.#columns.get("time");
    if (!time) throw new PageProblem("The run's data have no column “time”.");
    this.#time = time;
  }

  column(name: string): Column | undefined {
    return this.#columns.get(name);
  }

  time(row: number): number {
    return this.#time.at(row);
  }

  /** The row nearest to a time. */
  rowAt(time: number): number {
    let low = 0;
    let high = this.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.time(middle) < time) low = middle + 1;
      else high = middle;
    }
    const before = low > 0 && time - this.time(low - 1) < this.time(low) - time;
    return Math.max(0, before ? low - 1 : low);
  }
}

const ARRAYS = { f64: Float64Array, f32: Float32Array, i16: Int16Array, u8: Uint8Array };

/** The table whose columns stand one after the other in `bytes`. */
export function readTable(run: RunTable, bytes: Uint8Array): Table {
  let start = 0;
  const columns = run.columns.map((description) => {
    const end = start + run.rows * description.width * arrayOf(description).BYTES_PER_ELEMENT;
    if (end > bytes.length) {
      throw new PageProblem(
        `The run's data are cut off: ${bytes.length} bytes, but column “${description.name}” ends at ${end}.`,
      );
    }
    // A copy, as an f64 must start at a multiple of 8. All browsers run on little-endian machines.
    const stored = new (arrayOf(description))(bytes.slice(start, end).buffer);
    start = end;
    return new Column(description.name, description.width, stored, description.scale);
  });
  return new Table(columns, run.rows);
}

function arrayOf({ name, type }: Description) {
  const array = ARRAYS[type];
  if (!array)
    throw new PageProblem(`Column “${name}” is of the type “${type}”, which this page does not know.`);
  return array;
}
