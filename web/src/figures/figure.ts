/** An interactive figure, which replaces the static figure of the document. */
import type { Figure, Panel } from "../page_data";
import type { Playback } from "../playback";
import { PageProblem } from "../problem";
import type { Run } from "../run";
import { make } from "../ui/dom";
import { onTheme } from "../ui/theme";
import type { PanelView } from "./panel_view";
import { TimeAxis } from "./time_axis";
import { TimePanel } from "./time_panel";
import { XyPanel } from "./xy_panel";

/** Minimum width of a panel that is next to another one, and the gap between them (px). */
const NARROWEST = 200;
const GAP = 12;

/** Run and playback that figures are linked to. */
export interface Moments {
  run: Run;
  playback: Playback;
}

export class FigureView {
  readonly #panels: PanelView[];
  readonly #body: HTMLElement;
  readonly #columns: number;
  readonly #axis: TimeAxis | undefined;
  #row = 0;
  #visible = true;
  #width = 0;

  /** Inserts the figure into its `<figure>`. */
  constructor(figure: Figure, place: HTMLElement, moments: Moments | undefined) {
    const times = figure.panels.filter((panel) => panel.kind === "time");
    this.#axis = moments && new TimeAxis(moments.run.table, times[0]?.rows);
    this.#panels = figure.panels.map((panel) => this.#panel(panel, times, moments));
    this.#columns = figure.columns ?? 1;
    this.#body = make("div", { class: "panels" }, ...this.#panels.map((panel) => panel.element));
    place.prepend(this.#body);
    place.classList.add("interactive");
    new ResizeObserver(() => this.#fit(this.#body.clientWidth)).observe(this.#body);
    new IntersectionObserver(([entry]) => {
      this.#visible = entry?.isIntersecting ?? true;
      this.showRow(this.#row);
    }).observe(place);
    onTheme(() => this.#panels.forEach((panel) => panel.paint()));
  }

  showRow(row: number): void {
    this.#row = row;
    if (this.#visible) for (const panel of this.#panels) panel.showRow(row);
  }

  refresh(): void {
    if (!this.#visible) return;
    for (const panel of this.#panels) panel.refresh();
    this.#axis?.follow();
  }

  #panel(panel: Panel, times: Panel[], moments: Moments | undefined): PanelView {
    // Without a run, time is an ordinary axis.
    if (panel.kind === "xy" || (!moments && panel.series.every((series) => series.points))) {
      return new XyPanel(panel, moments?.playback);
    }
    if (!moments || !this.#axis)
      throw new PageProblem("This figure requires run data, but the page has none.");
    const place = { first: panel === times[0], last: panel === times.at(-1) };
    return new TimePanel(panel, moments.run, moments.playback, this.#axis, place);
  }

  #fit(width: number): void {
    // Panels also change the height.
    if (width <= 0 || width === this.#width) return;
    this.#width = width;
    const columns = Math.max(1, Math.min(this.#columns, Math.floor(width / NARROWEST)));
    this.#body.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
    const each = Math.floor((width - (columns - 1) * GAP) / columns);
    for (const panel of this.#panels) panel.setWidth(each);
    this.showRow(this.#row);
  }
}

/** The interactive figures of the page, each in its place in the document. */
export function figureViews(figures: Figure[], moments: Moments | undefined): FigureView[] {
  return figures.flatMap((figure) => {
    const id = `fig-${String(figure.number).padStart(2, "0")}`;
    const place = document.getElementById(id);
    if (!place || figure.panels.length === 0) return [];
    try {
      return [new FigureView(figure, place, moments)];
    } catch (error) {
      // The static figure remains.
      place.append(make("p", { class: "note" }, error instanceof Error ? error.message : String(error)));
      return [];
    }
  });
}
