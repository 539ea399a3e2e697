/** Sample documents, built from the same parts as the pages of feeler-report. */
import { readFileSync } from "node:fs";
import type { PageData } from "../src/page_data";
import { ROOT, still } from "./still";

const report = (file: string) => readFileSync(`${ROOT}/../crates/feeler-report/src/${file}`, "utf8");

export interface Parts {
  body: string;
  title: string;
  /** Text of `#page-data`. */
  data: string;
  script?: string;
}

export function html({ body, title, data, script = report("page.js") }: Parts): string {
  return `<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1"><title>${title}</title>
<style>${report("page.css")}</style></head><body>${body}
<script type="application/json" id="page-data">${data.replaceAll("<", "\\u003c")}</script>
<script>${script}</script></body></html>`;
}

export function reportPage(page: PageData): string {
  return html({ title: page.title, body: reportBody(page), data: JSON.stringify(page) });
}

export function reportBody(page: PageData): string {
  const [stroke1, stroke4] = [page.run?.strokes[0], page.run?.strokes[3]];
  return `<h1>Run report: ${page.title}</h1>
<p class="verdict"><span class="holds">Done.</span> The cap was closed in four strokes.
<span class="holds">All 3 claims of the paper pass.</span></p>
<div class="tiles">
  <div class="tile"><div class="value">3 of 3</div><div class="label">claims pass</div></div>
  <div class="tile"><div class="value">29.6 <span class="unit">mN·m</span></div><div class="label">closing torque</div></div>
  <div class="tile"><div class="value">4</div><div class="label">strokes</div></div>
  <div class="tile"><div class="value">19.2 <span class="unit">s</span></div><div class="label">simulated, 12.4 times real time</div></div>
</div>
<div id="scene"></div>
<h2>Claims of the paper</h2>
<div class="scroll"><table>
<thead><tr><th>Claim</th><th class="number">Value</th><th class="number">Bound</th><th>Result</th></tr></thead>
<tbody class="claim" data-row="${stroke1?.move[0] ?? 0}">
<tr><td colspan="3">In stroke 1, torque rises while grasp force stays constant <span class="unit">first-stroke-torque-rises</span></td><td><span class="holds">✓ pass</span></td></tr>
<tr><td class="part">rise of torque</td><td class="number">5.31 <span class="unit">mN·m</span></td><td class="number">≥ 2 <span class="unit">mN·m</span></td><td></td></tr></tbody>
<tbody class="claim"><tr data-time="${(stroke4?.move[0] ?? 0) / 100}"><td colspan="3">Strokes 3 and 4 are alike: the cap is closed after stroke 3 <span class="unit">closed-after-third</span></td><td><span class="holds">✓ pass</span></td></tr>
<tr><td class="part">difference of peaks</td><td class="number">0.021</td><td class="number">≤ 0.1</td><td></td></tr></tbody>
</table></div>
<h2>Figures</h2>
${figureElements(page)}
<h2>The run</h2>
<table><tbody><tr><th scope="row">Experiment</th><td>cap-closing</td></tr><tr><th scope="row">Seed</th><td>0</td></tr>
<tr><th scope="row">Sensing</th><td>image</td></tr></tbody></table>
<p>Digest of the recording (SHA-256):<br><span class="digest">${"0123456789abcdef".repeat(4)}</span></p>`;
}

export function livePage(page: PageData): string {
  const body = `<h1>Live: ${page.title}</h1><div id="live"></div><div id="scene"></div><h2>Figures</h2>${figureElements(page)}`;
  return html({ title: page.title, body, data: JSON.stringify(page) });
}

function figureElements(page: PageData): string {
  const one = (figure: PageData["figures"][number]) => {
    const title = figure.panels.map((panel) => panel.y.label).join(" and ");
    const picture = page.live ? "" : still(figure);
    return `<figure id="fig-${String(figure.number).padStart(2, "0")}">${picture}
<figcaption><b>Fig. ${figure.number}. ${title}. </b>A sample figure.</figcaption></figure>`;
  };
  return `<div class="figures">${page.figures.map(one).join("\n")}</div>`;
}
