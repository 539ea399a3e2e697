/** State lanes, which are filled while the state is active. */
import type uPlot from "uplot";
import type { Panel } from "../page_data";
import { pageColour } from "../ui/colours";
import { scaled } from "./shading";
import { FONT, seriesColour } from "./style";

/** Height of a lane (px). */
export const LANE = 20;
/** Margin above and below a bar, as a fraction of the lane's height. */
const FREE = 0.18;

export const hasLanes = (panel: Panel): boolean => panel.series.every((series) => series.line === "states");

/** Path builder for the bars of lane number `lane` from the top. The state of a row extends to the next row. */
export function bars(lane: number, lanes: number): uPlot.Series.PathBuilder {
  return (u, series, first, last) => {
    const fill = new Path2D();
    const [x, y] = [u.data[0] as number[], u.data[series] as (number | null)[]];
    const height = u.bbox.height / lanes;
    const top = u.bbox.top + (lane + FREE) * height;
    for (let start = first, i = first + 1; i <= last + 1; i++) {
      if (i <= last && Boolean(y[i]) === Boolean(y[start])) continue;
      const from = u.valToPos(x[start] ?? 0, "x", true);
      const to = u.valToPos(x[Math.min(i, last)] ?? 0, "x", true);
      if (y[start]) fill.rect(from, top, Math.max(1, to - from), height * (1 - 2 * FREE));
      start = i;
    }
    return { fill, stroke: null };
  };
}

/** Draws the names of the lanes at their left ends. */
export function nameLanes({ ctx, bbox }: uPlot, panel: Panel): void {
  const height = bbox.height / panel.series.length;
  ctx.save();
  ctx.font = scaled(FONT.replace("12px", "11px"));
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  ctx.lineWidth = 3 * devicePixelRatio;
  ctx.lineJoin = "round";
  panel.series.forEach((series, lane) => {
    const [x, y] = [bbox.left + 4 * devicePixelRatio, bbox.top + (lane + 0.5) * height];
    ctx.strokeStyle = pageColour("paper");
    ctx.strokeText(series.name, x, y);
    ctx.fillStyle = seriesColour(series);
    ctx.fillText(series.name, x, y);
  });
  ctx.restore();
}
