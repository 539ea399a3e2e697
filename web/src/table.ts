/** Column-oriented table of a run's rows. */
import type { Column as Description, RunTable } from "./page_data";
import { PageProblem } from "./problem";

type Stored = Float64Array | Float32Array | Int16Array | Uint8Array;

/** Stored value of an unknown number in columns of type i16. */
const UNKNOWN_I16 = -32768;

export class Column {
  constructor(
    readonly name: string,
    readonly width: number,
    readonly stored: Stored,
    private readonly scale: number,
  ) {}

  /** Number `k` of a row in SI units; NaN if it is unknown. */
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
    /** Number of valid rows. Columns may have capacity for more. */
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

  /** Row nearest to a time. */
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

/** Reads a table from its concatenated columns. */
export function readTable(run: RunTable, bytes: Uint8Array): Table {
  let start = 0;
  const columns = run.columns.map((description) => {
    const end = start + run.rows * description.width * arrayOf(description).BYTES_PER_ELEMENT;
    if (end > bytes.length) {
      throw new PageProblem(
        `The run's data are truncated: column “${description.name}” requires ${end} bytes, got ${bytes.length}.`,
      );
    }
    // Copies the bytes because an f64 must be aligned to 8 bytes. All browsers run on little-endian machines.
    const stored = new (arrayOf(description))(bytes.slice(start, end).buffer);
    start = end;
    return new Column(description.name, description.width, stored, description.scale);
  });
  return new Table(columns, run.rows);
}

function arrayOf({ name, type }: Description) {
  const array = ARRAYS[type];
  if (!array) throw new PageProblem(`Column “${name}” has the unknown type “${type}”.`);
  return array;
}
