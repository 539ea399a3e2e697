/** Strokes and phases in the background of time panels. */
import type uPlot from "uplot";
import type { Run } from "../run";
import { pageColour, phaseColour } from "../ui/colours";
import { FONT } from "./style";

/** Height of the phase strip (px). */
const STRIP = 4;
/** Shades the MOVE phases. Draws stroke numbers if `numbered`, and a strip of phase colours below if `phases`. */
export function shade(
  u: uPlot,
  run: Run,
  { numbered, phases }: { numbered: boolean; phases: boolean },
): void {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  for (const { move, index } of run.strokes) {
    const [left, right] = spanOf(u, run, move[0], move[1]);
    ctx.fillStyle = pageColour("shade");
    ctx.fillRect(left, bbox.top, right - left, bbox.height);
    if (numbered) writeNumber(u, String(index), (left + right) / 2);
  }
  if (phases) strip(u, run);
  ctx.restore();
}

function writeNumber({ ctx, bbox }: uPlot, text: string, x: number): void {
  ctx.font = scaled(FONT);
  ctx.fillStyle = pageColour("soft");
  ctx.textAlign = "center";
  ctx.textBaseline = "top";
  ctx.fillText(text, x, bbox.top + 3 * devicePixelRatio);
}

function strip(u: uPlot, run: Run): void {
  const { ctx, bbox } = u;
  const height = STRIP * devicePixelRatio;
  const rows = run.table.length;
  for (let start = 0, row = 1; row <= rows; row++) {
    const phase = run.phaseNumber(start);
    if (row < rows && run.phaseNumber(row) === phase) continue;
    const [left, right] = spanOf(u, run, start, row);
    start = row;
    if (phase < 0) continue;
    ctx.fillStyle = phaseColour(phase);
    ctx.fillRect(left, bbox.top + bbox.height - height, right - left, height);
  }
}

/** Left and right end of the rows from `start` up to, but not including, `end`. */
function spanOf(u: uPlot, { table }: Run, start: number, end: number): [number, number] {
  const at = (row: number) => u.valToPos(table.time(Math.min(row, table.length - 1)), "x", true);
  return [at(start), at(end)];
}

/** The font scaled to canvas pixels. */
export function scaled(font: string): string {
  return font.replace(/(\d+)px/, (_, size) => `${Number(size) * devicePixelRatio}px`);
}
