/** Styles of series and axes for light and dark themes. */
import type uPlot from "uplot";
import type { Axis, Series } from "../page_data";
import { significant, tick } from "../format";
import { decades } from "./plane";
import { fingerColour, pageColour } from "../ui/colours";
import { isDark } from "../ui/theme";

export const FONT = '12px system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif';
/** Width of the y axis (px), equal for all panels so that their time axes align. */
const GUTTER = 54;
const X_AXIS = 22;
const DASHES = [6, 4];

export function seriesColour({ colour }: Series): string {
  if (colour === "shared") return pageColour("ink");
  if (colour === "reference") return pageColour("soft");
  if (colour === "background") return isDark() ? "#7d858d" : "#a3a9af";
  return fingerColour(Number(colour.slice("finger-".length)), isDark());
}

/** The first finger has a wider line, so that it remains visible under an identical one. */
function lineWidth({ colour }: Series): number {
  if (colour === "background") return 1;
  return colour === "finger-0" ? 2.4 : 1.4;
}

/** Translucent colour of the series for bands. */
export function bandColour(series: Series): string {
  return `color-mix(in srgb, ${seriesColour(series)} 20%, transparent)`;
}

/** Options for uPlot that all series share. */
export function seriesOptions(series: Series): uPlot.Series {
  return {
    label: series.name,
    stroke: () => seriesColour(series),
    width: lineWidth(series),
    points: { show: false },
    ...(series.line === "dashed" && { dash: DASHES }),
  };
}

/** Axis title, such as "Grasp force (N)". */
export function axisTitle({ label, unit }: Axis): string {
  return unit && !label.includes(`(${unit})`) ? `${label} (${unit})` : label;
}

/** uPlot options of both axes. Without `x`, the x axis is hidden; without `upright`, the y axis has no labels. */
export function axesOptions(x: { title: string; log?: boolean } | undefined, upright: boolean): uPlot.Axis[] {
  const common = {
    stroke: () => pageColour("soft"),
    font: FONT,
    labelFont: FONT,
    grid: { stroke: () => pageColour("grid"), width: 1 },
    ticks: { show: false },
    values: (_: uPlot, splits: number[], _axis: number, _space: number, step: number) =>
      splits.map((split) => tick(split, step)),
  };
  return [
    {
      ...common,
      size: x ? X_AXIS : 4,
      ...(x ? { label: x.title, labelSize: 18, labelGap: 0, gap: 2 } : { values: () => [] }),
      ...(x?.log && {
        splits: (_u: uPlot, _axis: number, low: number, high: number) => decades(low, high),
        values: (_u: uPlot, splits: number[]) => splits.map((split) => significant(10 ** split)),
      }),
    },
    { ...common, size: GUTTER, ...(!upright && { values: () => [], grid: { show: false } }) },
  ];
}
