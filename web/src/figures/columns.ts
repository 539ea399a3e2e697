/** Values of a series at the rows of a run. */
import type { Series } from "../page_data";
import { PageProblem } from "../problem";
import type { Table } from "../table";

/** Value of a series at a row in SI units; NaN if there is none. */
export type At = (row: number) => number;

export function seriesAt(series: Series, table: Table): At {
  if (series.column) return columnAt(series.column, series.name, table);
  if (series.points) return pointsAt(series.points, table);
  throw new PageProblem(`Series “${series.name}” has neither a column nor points.`);
}

function columnAt(from: NonNullable<Series["column"]>, series: string, table: Table): At {
  const column = table.column(from.name);
  if (!column)
    throw new PageProblem(`Series “${series}” needs column “${from.name}”, which was not recorded.`);
  const { index, bit } = from;
  if (bit === undefined) return (row) => column.at(row, index);
  return (row) => {
    const value = column.at(row, index);
    return Number.isFinite(value) ? (value >> bit) & 1 : NaN;
  };
}

/** Separate points are assigned to the rows nearest to their times. */
function pointsAt({ x, y, row }: NonNullable<Series["points"]>, table: Table): At {
  const values = new Map<number, number>();
  x.forEach((time, i) => values.set(row?.[i] ?? table.rowAt(time), y[i] ?? NaN));
  return (at) => values.get(at) ?? NaN;
}

/** Values of all rows for uPlot; `null` if there is no value. */
export function plotted(at: At, rows: number, scale: number): (number | null)[] {
  return Array.from({ length: rows }, (_, row) => {
    const value = at(row);
    return Number.isFinite(value) ? value * scale : null;
  });
}
