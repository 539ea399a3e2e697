/** Points of a series in a plane: drawing, and search near the cursor. */
import type uPlot from "uplot";
import type { Axis, Series } from "../page_data";
import { placeOn } from "./plane";

/** Radius of a dot (px). */
const DOT = 3.2;

/** Points in axis coordinates; gaps are NaN. */
export interface Points {
  series: Series;
  x: number[];
  y: number[];
  /** Ends of the intervals in y; empty if there are no intervals. */
  low: number[];
  high: number[];
}

export function pointsOf(series: Series, x: Axis, y: Axis): Points {
  const points = series.points ?? { x: [], y: [] };
  const upright = (values: (number | null)[] = []) => values.map((value) => placeOn(y, value ?? NaN));
  return {
    series,
    x: points.x.map((value) => placeOn(x, value)),
    y: upright(points.y),
    low: upright(points.low),
    high: upright(points.high),
  };
}

/** Shell command that reproduces a point of a page in `folder`; undefined if the point has none. */
export function commandOf({ series }: Points, index: number, folder: string): string | undefined {
  const { pattern, trial } = series.points?.command ?? {};
  if (!pattern || !trial) return undefined;
  const words = pattern
    .split(" ")
    .map((word) => word.replace("{folder}", () => folder).replace("{trial}", String(trial[index])));
  // Quotes words that the shell would split or interpret.
  const quoted = (word: string) => (/^[\w/.:+-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);
  return words.map(quoted).join(" ");
}

/** Folder of the page with this address; `.` if the page is not a file. */
export function folderOf(address: string): string {
  const { protocol, pathname } = new URL(address);
  if (protocol !== "file:") return ".";
  const folder = decodeURIComponent(pathname).replace(/\/[^/]*$/, "");
  // On Windows, the drive follows the first slash.
  return folder.replace(/^\/([A-Za-z]:)/, "$1") || "/";
}

/** Path builder for arbitrary points; the built-in paths of uPlot require increasing x. */
export function drawn(points: Points): uPlot.Series.PathBuilder {
  return (u) => {
    if (points.series.line === "points") {
      const dots = dotsOf(u, points);
      const stroke = new Path2D(dots);
      stroke.addPath(whiskers(u, points));
      return { stroke, fill: dots };
    }
    return { stroke: lineOf(u, points), fill: points.low.length ? band(u, points) : null };
  };
}

/** Canvas coordinates; NaN for unknown points. */
function places(u: uPlot, { x }: Points, y: number[]): [number, number][] {
  return x.map((value, i) => [u.valToPos(value, "x", true), u.valToPos(y[i] ?? NaN, "y", true)]);
}

const isPlace = ([x, y]: [number, number]) => Number.isFinite(x + y);

function dotsOf(u: uPlot, points: Points): Path2D {
  const path = new Path2D();
  const radius = DOT * devicePixelRatio;
  for (const [x, y] of places(u, points, points.y).filter(isPlace)) {
    path.moveTo(x + radius, y);
    path.arc(x, y, radius, 0, 2 * Math.PI);
  }
  return path;
}

function lineOf(u: uPlot, points: Points): Path2D {
  const path = new Path2D();
  let open = false;
  for (const place of places(u, points, points.y)) {
    if (open && isPlace(place)) path.lineTo(...place);
    else if (isPlace(place)) path.moveTo(...place);
    open = isPlace(place);
  }
  return path;
}

function whiskers(u: uPlot, points: Points): Path2D {
  const path = new Path2D();
  const tops = places(u, points, points.high);
  places(u, points, points.low).forEach((bottom, i) => {
    const top = tops[i];
    if (!top || !isPlace(bottom) || !isPlace(top)) return;
    path.moveTo(...bottom);
    path.lineTo(...top);
  });
  return path;
}

function band(u: uPlot, points: Points): Path2D {
  const path = new Path2D();
  const low = places(u, points, points.low).filter(isPlace);
  const high = places(u, points, points.high).filter(isPlace);
  low.concat(high.reverse()).forEach((place, i) => (i ? path.lineTo(...place) : path.moveTo(...place)));
  path.closePath();
  return path;
}

/** Point nearest to a position of the panel, within `reach` px. */
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

/** Index of the last point whose row is not after `row`; undefined if `row` is outside the points' range of rows. */
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
