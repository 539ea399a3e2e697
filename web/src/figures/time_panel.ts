/** A panel with quantities over time. */
import uPlot from "uplot";
import { quantity } from "../format";
import type { Panel } from "../page_data";
import type { Playback } from "../playback";
import type { Run } from "../run";
import { type At, plotted, seriesAt } from "./columns";
import { startGestures } from "./gestures";
import { bars, hasLanes, LANE, nameLanes } from "./lanes";
import { Legend } from "./legend";
import type { PanelView } from "./panel_view";
import { shade } from "./shading";
import { axesOptions, axisTitle, seriesColour, seriesOptions } from "./style";
import { drawThresholds } from "./thresholds";
import type { TimeAxis } from "./time_axis";

const HEIGHT = 150;
/** Additional height of the lowest panel for the time axis. */
const AXIS = 40;
/** Minimum length of a drag that zooms (px). */
const DRAG = 6;

export class TimePanel implements PanelView {
  readonly element: HTMLElement;
  readonly #panel: Panel;
  readonly #run: Run;
  readonly #playback: Playback;
  readonly #axis: TimeAxis;
  readonly #values: At[];
  readonly #legend: Legend;
  readonly #plot: uPlot;
  readonly #height: number;

  constructor(
    panel: Panel,
    run: Run,
    playback: Playback,
    axis: TimeAxis,
    place: { first: boolean; last: boolean },
  ) {
    this.#panel = panel;
    this.#run = run;
    this.#playback = playback;
    this.#axis = axis;
    this.#values = panel.series.map((series) => seriesAt(series, run.table));
    this.#legend = new Legend(panel, (i, show) => this.#plot.setSeries(i + 1, { show }));
    const body = hasLanes(panel) ? LANE * panel.series.length : HEIGHT;
    this.#height = body + (place.last ? AXIS : 4);
    const canvas = document.createElement("div");
    canvas.className = "plot";
    this.element = document.createElement("div");
    this.element.append(this.#legend.element, canvas);
    this.#plot = new uPlot(this.#options(place), this.#data(), canvas);
    axis.add(this.#plot);
    startGestures(this.#plot.over, {
      point: (x) => this.#seek(x),
      pinch: (from, to) => axis.pinch(this.#plot, from, to),
      reset: () => axis.reset(),
      click: (x) => this.#seek(x),
    });
  }

  setWidth(width: number): void {
    this.#plot.setSize({ width, height: this.#height });
  }

  showRow(row: number): void {
    const left = this.#plot.valToPos(this.#run.table.time(row), "x");
    // Reading the element's width instead would trigger a layout.
    const inside = left >= 0 && left <= this.#plot.bbox.width / devicePixelRatio;
    this.#plot.setCursor({ left: inside ? left : -10, top: 0 }, false);
    this.#legend.show((i) => this.#read(i, row));
  }

  paint(): void {
    this.#legend.paint();
    this.#plot.redraw();
  }

  refresh(): void {
    this.#plot.setData(this.#data(), false);
  }

  #read(i: number, row: number): string {
    const value = this.#values[i]?.(row) ?? NaN;
    if (this.#panel.series[i]?.line === "states") return Number.isNaN(value) ? "–" : value ? "yes" : "no";
    return quantity(value, this.#panel.y.unit, this.#panel.y.scale);
  }

  #data(): uPlot.AlignedData {
    const { table } = this.#run;
    const time = Array.from({ length: table.length }, (_, row) => table.time(row));
    return [time, ...this.#values.map((at) => plotted(at, table.length, this.#panel.y.scale))];
  }

  #options({ first, last }: { first: boolean; last: boolean }): uPlot.Options {
    const lanes = hasLanes(this.#panel);
    const count = this.#panel.series.length;
    return {
      width: 400,
      height: this.#height,
      legend: { show: false },
      padding: [6, 12, 0, 0],
      scales: {
        x: { time: false, range: (_, low, high) => [low ?? 0, high ?? 1] },
        y: { range: (_, low, high) => (lanes ? [0, 1] : this.#range(low, high)) },
      },
      axes: axesOptions(last ? { title: axisTitle(this.#panel.x) } : undefined, !lanes),
      series: [
        {},
        ...this.#panel.series.map((series, lane) => ({
          ...seriesOptions(series),
          ...(series.points && { spanGaps: true }),
          ...(series.line === "states" && { paths: bars(lane, count), fill: () => seriesColour(series) }),
          ...(series.line === "points" && { paths: () => null, points: { show: true, size: 5 } }),
        })),
      ],
      cursor: this.#cursor(lanes),
      hooks: {
        drawClear: [(u) => shade(u, this.#run, { numbered: first, phases: !lanes })],
        draw: [(u) => (lanes ? nameLanes(u, this.#panel) : drawThresholds(u, this.#panel))],
        setSelect: [(u) => this.#zoom(u)],
      },
    };
  }

  #cursor(lanes: boolean): uPlot.Cursor {
    return {
      y: false,
      drag: { x: true, y: false, setScale: false },
      points: { size: lanes ? 0 : 7 },
      bind: {
        mousemove: (u, _target, handle) => (event) => {
          handle(event);
          if (!this.#playback.playing) this.#seek(u.cursor.left ?? -1);
          return null;
        },
        // The cursor stays at the page's current time.
        mouseleave: () => null,
        dblclick: () => () => {
          this.#axis.reset();
          return null;
        },
      },
    };
  }

  #seek(left: number): void {
    if (left < 0) return;
    if (this.#playback.live) this.#playback.pause();
    this.#playback.seekTime(this.#plot.posToVal(left, "x"));
  }

  #zoom(u: uPlot): void {
    const { left, width } = u.select;
    if (width >= DRAG) this.#axis.show(u.posToVal(left, "x"), u.posToVal(left + width, "x"));
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  }

  /** Range of the y axis: as given, or fitted to data and thresholds with a margin. */
  #range(low: number | null, high: number | null): [number, number] {
    const { range, scale } = this.#panel.y;
    if (range) return [range[0] * scale, range[1] * scale];
    const known = this.#panel.thresholds.map((threshold) => threshold.value * scale);
    const [least, most] = [Math.min(low ?? 0, ...known), Math.max(high ?? 1, ...known)];
    const air = 0.06 * (most - least || 1);
    return [least === 0 ? 0 : least - air, most + air];
  }
}
