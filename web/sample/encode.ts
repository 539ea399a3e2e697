/** Encodes rows as columns of a page, like feeler-report. */
import { deflateRawSync } from "node:zlib";
import type { Column, RunTable } from "../src/page_data";
import { PHASES, type Row, type Simulated } from "./simulate";

interface Written extends Column {
  values: (row: Row) => number[];
}

/** The columns, with the values of a row. */
export function columns(fingers: number, elements: number): Written[] {
  const each = Array.from({ length: fingers }, (_, f) => f);
  const column = (
    name: string,
    type: Column["type"],
    width: number,
    scale: number,
    values: Written["values"],
  ): Written => ({ name, type, width, scale, values });
  return [
    column("time", "f64", 1, 1, (row) => [row.time]),
    column("phase", "u8", 1, 1, (row) => [row.phase]),
    ...each.flatMap((f) => [
      column(`finger/${f}/joints`, "f32", 3, 1, (row) => row.joints[f] ?? []),
      column(`finger/${f}/forces`, "i16", 3 * elements, 1e-4, (row) => row.forces[f] ?? []),
      column(`finger/${f}/flags`, "u8", 1, 1, (row) => [row.flags[f] ?? 0]),
      column(`finger/${f}/grasp_force`, "f32", 1, 1, (row) => [row.graspForce[f] ?? 0]),
      column(`finger/${f}/shear_rate`, "f32", 1, 1, (row) => [row.shearRate[f] ?? 0]),
    ]),
    column("torque", "f32", 1, 1, (row) => [row.torque]),
    column("cap_angle", "f32", 1, 1, (row) => [row.capAngle]),
    column("frame/cap", "f32", 7, 1, ({ capAngle, capHeight }) => {
      return [0, 0, capHeight, 0, 0, Math.sin(capAngle / 2), Math.cos(capAngle / 2)];
    }),
  ];
}

export function runTable({ rows, strokes }: Simulated, fingers: number, elements: number): RunTable {
  const written = columns(fingers, elements);
  const bytes = Buffer.concat(written.map((column) => packed(column, rows)));
  return {
    rows: rows.length,
    columns: written.map(({ name, type, width, scale }) => ({ name, type, width, scale })),
    data: deflateRawSync(bytes, { level: 9 }).toString("base64"),
    phases: PHASES,
    strokes,
  };
}

function packed({ type, width, scale, values }: Written, rows: Row[]): Buffer {
  const array = { f64: Float64Array, f32: Float32Array, i16: Int16Array, u8: Uint8Array }[type];
  const stored = new array(rows.length * width);
  rows.forEach((row, r) =>
    values(row).forEach((value, k) => {
      const number = value / scale;
      stored[r * width + k] = type === "i16" || type === "u8" ? Math.round(number) : number;
    }),
  );
  return Buffer.from(stored.buffer);
}

/** A row in the format of a live page's socket. */
export function rowMessage(row: Row, written: Written[]): ArrayBuffer {
  const rest = written.filter(({ name }) => name !== "time");
  const message = new DataView(new ArrayBuffer(8 + 4 * rest.reduce((sum, { width }) => sum + width, 0)));
  message.setFloat64(0, row.time, true);
  rest.flatMap(({ values }) => values(row)).forEach((value, i) => message.setFloat32(8 + 4 * i, value, true));
  return message.buffer;
}
