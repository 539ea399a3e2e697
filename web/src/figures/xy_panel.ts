/** A panel with points in a plane: paths, scatter plots and curves over quantities other than time. */
import uPlot from "uplot";
import { quantity } from "../format";
import type { Panel } from "../page_data";
import type { Playback } from "../playback";
import { make } from "../ui/dom";
import { startGestures } from "./gestures";
import { Legend } from "./legend";
import type { PanelView } from "./panel_view";
import { equalScale, pinched, placeOn, type Range, type Window, windowAround } from "./plane";
import { commandOf, drawn, folderOf, nearest, pointAtRow, type Points, pointsOf } from "./points";
import { axesOptions, axisTitle, bandColour, seriesColour, seriesOptions } from "./style";
import { drawThresholds } from "./thresholds";
import { Tooltip } from "./tooltip";

/** Width of the y axis and height of the x axis (px). */
const AXES: [number, number] = [66, 48];
const HEIGHTS: Range = [180, 440];
/** Ratio of height to width, for panels without equal scales. */
const ASPECT = 0.6;
/** Maximum distance between the cursor and the point that it selects (px). */
const REACH = 28;
/** Minimum length of a drag that zooms (px). */
const DRAG = 6;

export class XyPanel implements PanelView {
  readonly element: HTMLElement;
  readonly #panel: Panel;
  readonly #playback: Playback | undefined;
  readonly #points: Points[];
  readonly #all: Window;
  /** Requested window, and the window with equal scales that contains it. */
  #wanted: Window;
  #window: Window;
  readonly #legend: Legend;
  readonly #plot: uPlot;
  readonly #tooltip: Tooltip;
  readonly #dots: HTMLElement[];

  constructor(panel: Panel, playback: Playback | undefined) {
    this.#panel = panel;
    this.#playback = playback;
    this.#points = panel.series.map((series) => pointsOf(series, panel.x, panel.y));
    this.#window = this.#wanted = this.#all = this.#everything();
    this.#legend = new Legend(panel, (i, show) => this.#plot.setSeries(i + 1, { show }));
    const canvas = make("div", { class: "plot" });
    this.element = make("div", {}, this.#legend.element, canvas);
    const data = [null, ...this.#points.map(({ x, y }) => [x, y])] as unknown as uPlot.AlignedData;
    this.#plot = new uPlot(this.#options(), data, canvas);
    this.#tooltip = new Tooltip(this.#plot.over);
    this.#dots = this.#points.map(() => make("i", { class: "moment-dot", hidden: "" }));
    this.#plot.over.append(...this.#dots);
    startGestures(this.#plot.over, {
      point: (x, y) => this.#point(x, y),
      pinch: (from, to) => this.#show(pinched(this.#window, this.#plot.over.clientWidth, from, to)),
      reset: () => this.#show(this.#all),
      click: (x, y) => this.#click(x, y),
    });
  }

  setWidth(width: number): void {
    const { x, y } = this.#all;
    const inner = width - AXES[0];
    const height = this.#panel.equal ? (inner * (y[1] - y[0])) / (x[1] - x[0]) : ASPECT * inner;
    const bounded = Math.min(Math.max(height, HEIGHTS[0]), HEIGHTS[1]);
    // In a batch, because equal scales depend on the current size.
    this.#plot.batch(() => this.#plot.setSize({ width, height: Math.round(bounded + AXES[1]) }));
    this.#show(this.#wanted);
  }

  showRow(row: number): void {
    this.#points.forEach((points, i) => {
      const dot = this.#dots[i];
      if (!dot) return;
      const index = pointAtRow(points, row);
      const [x, y] = [points.x[index ?? -1] ?? NaN, points.y[index ?? -1] ?? NaN];
      const { x: horizontal, y: upright } = this.#window;
      const inside = x >= horizontal[0] && x <= horizontal[1] && y >= upright[0] && y <= upright[1];
      dot.hidden = !inside || this.#plot.series[i + 1]?.show === false;
      if (dot.hidden) return;
      dot.style.transform = `translate(${this.#plot.valToPos(x, "x")}px, ${this.#plot.valToPos(y, "y")}px)`;
      dot.style.background = seriesColour(points.series);
    });
  }

  paint(): void {
    this.#legend.paint();
    this.#plot.redraw();
  }

  /** Does nothing: the points do not depend on the rows. */
  refresh(): void {}

  #everything(): Window {
    const { x, y, thresholds } = this.#panel;
    const points = this.#points.flatMap(({ x, y, low, high }) =>
      [y, low, high].flatMap((values) => values.map((value, i) => [x[i] ?? NaN, value] as const)),
    );
    const all = windowAround(points.concat(thresholds.map(({ value }) => [NaN, value * y.scale] as const)));
    const given = (axis: typeof x, range: Range): Range =>
      axis.range ? [placeOn(axis, axis.range[0]), placeOn(axis, axis.range[1])] : range;
    return { x: given(x, all.x), y: given(y, all.y) };
  }

  #options(): uPlot.Options {
    const range = (axis: "x" | "y") => ({ time: false, auto: false, range: () => this.#window[axis] });
    return {
      mode: 2,
      width: 400,
      height: 300,
      legend: { show: false },
      padding: [8, 12, 0, 0],
      scales: { x: range("x"), y: range("y") },
      axes: axesOptions({ title: axisTitle(this.#panel.x), log: this.#panel.x.log === true }, true),
      series: [
        null as unknown as uPlot.Series,
        ...this.#points.map((points) => ({
          ...seriesOptions(points.series),
          paths: drawn(points),
          fill: () => (points.series.line === "points" ? seriesColour : bandColour)(points.series),
        })),
      ],
      cursor: {
        x: false,
        y: false,
        points: { show: false },
        drag: { x: true, y: true, uni: 20, setScale: false },
        bind: {
          mousemove: (u, _target, handle) => (event) => {
            handle(event);
            this.#point(u.cursor.left ?? -1, u.cursor.top ?? -1);
            return null;
          },
          mouseleave: (_u, _target, handle) => (event) => {
            handle(event);
            this.#tooltip.hide();
            return null;
          },
          dblclick: () => () => {
            this.#show(this.#all);
            return null;
          },
        },
      },
      hooks: { setSelect: [(u) => this.#zoom(u)], draw: [(u) => drawThresholds(u, this.#panel)] },
    };
  }

  #point(left: number, top: number): void {
    const found = nearest(this.#plot, this.#points, left, top, REACH);
    if (!found) {
      this.#tooltip.hide();
      return;
    }
    const { points, index } = found;
    this.#tooltip.show(this.#told(points, index), left, top);
    const row = points.series.points?.row?.[index];
    if (row !== undefined && this.#playback && !this.#playback.playing) this.#playback.seek(row);
  }

  /** Tooltip lines of a point. */
  #told(points: Points, index: number): string[] {
    const { x, y } = this.#panel;
    const list = points.series.points;
    const value = (axis: typeof x, values: (number | null)[] = []) =>
      quantity(values[index] ?? NaN, axis.unit, axis.scale);
    const interval = list?.low ? ` [${value(y, list.low)}, ${value(y, list.high)}]` : "";
    const told = [`${x.label}: ${value(x, list?.x)}`, `${y.label}: ${value(y, list?.y)}${interval}`];
    const command = commandOf(points, index, folderOf(location.href));
    const lines = [points.series.name, ...told, list?.label?.[index] ?? ""];
    return lines.concat(command ? [command, "Click to copy"] : []).filter(Boolean);
  }

  #click(left: number, top: number): void {
    const found = nearest(this.#plot, this.#points, left, top, REACH);
    if (!found) return;
    const at = found.points.series.points?.row?.[found.index];
    if (at !== undefined) this.#playback?.stopAt(at);
    const command = commandOf(found.points, found.index, folderOf(location.href));
    if (command) void this.#tooltip.copy(command, left, top);
  }

  #zoom(u: uPlot): void {
    const { left, top, width, height } = u.select;
    if (width >= DRAG || height >= DRAG) {
      const x: Range = [u.posToVal(left, "x"), u.posToVal(left + width, "x")];
      const y: Range = [u.posToVal(top + height, "y"), u.posToVal(top, "y")];
      this.#show({ x: width >= DRAG ? x : this.#window.x, y: height >= DRAG ? y : this.#window.y });
    }
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  }

  #show(window: Window): void {
    const { clientWidth, clientHeight } = this.#plot.over;
    const equal = this.#panel.equal && clientWidth > 0 && clientHeight > 0;
    this.#wanted = window;
    this.#window = equal ? equalScale(window, clientWidth, clientHeight) : window;
    const { x, y } = this.#window;
    this.#plot.batch(() => {
      this.#plot.setScale("x", { min: x[0], max: x[1] });
      this.#plot.setScale("y", { min: y[0], max: y[1] });
    });
    if (this.#playback) this.showRow(this.#playback.row);
  }
}
