/** Reads the run from the page data of a report. */
import { inflate } from "../src/inflate";
import type { PageData } from "../src/page_data";
import { readPage } from "../src/read_page";
import { FingerColumns, Run } from "../src/run";
import { readTable, type Table } from "../src/table";

export interface Recorded {
  data: PageData;
  table: Table;
  run: Run;
  fingers: FingerColumns[];
}

export async function recorded(html: string): Promise<Recorded> {
  const data = /id="page-data">(.*?)<\/script>/s.exec(html)?.[1] ?? "";
  const page = readPage(data);
  if (!page.run || !page.scene) throw new Error("the report is not of a run");
  const table = readTable(page.run, await inflate(page.run.data));
  return {
    data: page,
    table,
    run: new Run(table, page.run),
    fingers: page.scene.fingers.map((finger, number) => new FingerColumns(table, number, finger)),
  };
}

/** Times at which the phase `name` begins (s). */
export function begins({ table, run }: Recorded, name: string): number[] {
  const times: number[] = [];
  for (let row = 0; row < table.length; row++) {
    if (run.phase(row) === name && (row === 0 || run.phase(row - 1) !== name)) times.push(table.time(row));
  }
  return times;
}
