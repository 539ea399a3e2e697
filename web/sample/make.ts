/** Writes the sample pages to `out/`: a report of four strokes, a report of one minute, and a damaged report. */
import { mkdirSync, writeFileSync } from "node:fs";
import { reportPage } from "./document";
import { reportData } from "./page_data";
import { simulate } from "./simulate";

const folder = "out/pages";
mkdirSync(folder, { recursive: true });
const write = (name: string, text: string) => {
  writeFileSync(`${folder}/${name}`, text);
  console.log(`${folder}/${name}: ${(text.length / 1000).toFixed(0)} kB`);
};
const report = reportData(simulate(4));
write("sample.html", reportPage(report));
write("minute.html", reportPage(reportData(simulate(13))));
const damaged = { ...report, run: report.run && { ...report.run, data: report.run.data.slice(0, 4000) } };
write("damaged.html", reportPage(damaged));
