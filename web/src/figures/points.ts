/** The points of a series in a plane: drawn, and found under a cursor. */
import type uPlot from "uplot";
import type { Axis, Series } from "../page_data";

/** Radius of a dot, px. */
const DOT = 3.2;

/** Points as they are drawn: in the axes' units, with gaps as NaN. */
export interface Points {
  series: Series;
  x: number[];
  y: number[];
}

export function pointsOf(series: Series, x: Axis, y: Axis): Points {
  const points = series.points ?? { x: [], y: [] };
  return {
    series,
    x: points.x.map((value) => value * x.scale),
    y: points.y.map((value) => (value ?? NaN) * y.scale),
  };
}

/** uPlot's own paths need x to rise; a path in the plane goes anywhere. */
export function drawn({ series, x, y }: Points): uPlot.Series.PathBuilder {
  return (u) => {
    const path = new Path2D();
    const radius = DOT * devicePixelRatio;
    let open = false;
    x.forEach((value, i) => {
      const [px, py] = [u.valToPos(value, "x", true), u.valToPos(y[i] ?? NaN, "y", true)];
      if (!Number.isFinite(px + py)) {
        open = false;
      } else if (series.line === "points") {
        path.moveTo(px + radius, py);
        path.arc(px, py, radius, 0, 2 * Math.PI);
      } else {
        if (open) path.lineTo(px, py);
        else path.moveTo(px, py);
        open = true;
      }
    });
    const fill = series.line === "points" ? path : null;
    return { stroke: path, fill };
  };
}

/** The point nearest to a place of the panel, no farther than `reach`, px. */
export function nearest(u: uPlot, all: Points[], left: number, top: number, reach: number) {
  let best: { points: Points; index: number; series: number } | undefined;
  let least = reach;
  all.forEach((points, series) => {
    if (u.series[series + 1]?.show === false) return;
    points.x.forEach((value, index) => {
      const distance = Math.hypot(
        u.valToPos(value, "x") - left,
        u.valToPos(points.y[index] ?? NaN, "y") - top,
      );
      if (!(distance < least)) return;
      least = distance;
      best = { points, index, series };
    });
  });
  return best;
}

/** The point that belongs to a row, or to the nearest before it; none outside of the points' rows. */
export function pointAtRow({ series }: Points, row: number): number | undefined {
  const rows = series.points?.row;
  if (!rows?.length || row < Math.min(rows[0] ?? 0, rows.at(-1) ?? 0)) return undefined;
  let best: number | undefined;
  let last = -Infinity;
  for (const [i, at] of rows.entries()) {
    if (at <= row && at > last) [best, last] = [i, at];
  }
  const newest = Math.max(rows[0] ?? 0, rows.at(-1) ?? 0);
  return row > newest + 1 ? undefined : best;
}
