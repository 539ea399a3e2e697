/** One run on the page: scene, fingertips, flags and figures, updated while it is computed. */
import { FingertipPanel } from "../src/fingertip/panel";
import { FigureView } from "../src/figures/figure";
import { LivePanel } from "../src/live/panel";
import { Ring } from "../src/live/ring";
import type { PageData } from "../src/page_data";
import { Playback } from "../src/playback";
import { PageProblem } from "../src/problem";
import { FingerColumns, Run } from "../src/run";
import { scenePanel } from "../src/scene/panel";
import { make } from "../src/ui/dom";
import type { RunState } from "./protocol";

/** Refresh interval of the figures (ms). */
const REFRESH = 200;

export class RunView {
  readonly element: HTMLElement;
  readonly playback: Playback;
  readonly run: Run;
  readonly #panel: LivePanel;
  readonly #ring: Ring;
  readonly #rowBytes: number;
  readonly #fingers: FingerColumns[];
  readonly #forgetTrails: () => void;
  readonly #refresh: ReturnType<typeof setInterval>;

  /** `keep` is the number of rows that stay visible. */
  constructor(page: PageData, title: string, keep: number, order: (order: "stop" | "resume") => void) {
    if (!page.run || !page.scene) throw new PageProblem("This experiment has no scene.");
    this.#ring = new Ring(page.run.columns, keep);
    this.#rowBytes = page.run.columns.reduce(
      (bytes, { name, width }) => bytes + width * (name === "time" ? 8 : 4),
      0,
    );
    const { table } = this.#ring;
    this.run = new Run(table, page.run);
    this.playback = new Playback(table, { live: true });
    this.#fingers = page.scene.fingers.map((finger, i) => new FingerColumns(table, i, finger));
    this.#panel = new LivePanel(this.#fingers, true, order);
    this.#panel.connected(true);
    const scene = scenePanel(page.scene, this.run, this.#fingers);
    this.#forgetTrails = () => scene.model?.forgetTrails();
    const tips = this.#fingers.map((columns) => new FingertipPanel(columns));
    const places = page.figures.map((figure) => {
      const label = figure.panels[0]?.y.label ?? "";
      const place = make("figure", {}, make("figcaption", {}, make("b", {}, label)));
      return { figure, place };
    });
    this.element = make(
      "section",
      { class: "run-view", "aria-label": title },
      make("h3", {}, title),
      this.#panel.element,
      make(
        "div",
        { class: "scene" },
        scene.element,
        make("div", { class: "fingertips" }, ...tips.map((tip) => tip.element)),
      ),
      make("div", { class: "figures" }, ...places.map(({ place }) => place)),
    );
    const moments = { run: this.run, playback: this.playback };
    const figures = places.map(({ figure, place }) => new FigureView(figure, place, moments));
    this.playback.onMoment((row) => {
      scene.view?.moveTo(row);
      for (const tip of tips) tip.show(row);
      for (const figure of figures) figure.showRow(row);
    });
    this.#refresh = setInterval(() => {
      if (!document.hidden) for (const figure of figures) figure.refresh();
    }, REFRESH);
  }

  /** Adds rows, one after the other in `rows`, and shows the state. */
  add(rows: ArrayBuffer, state: RunState): void {
    for (let start = 0; start < rows.byteLength; start += this.#rowBytes) {
      const gone = this.#ring.add(rows.slice(start, start + this.#rowBytes));
      if (gone === 0) continue;
      this.playback.shift(gone);
      this.#forgetTrails();
    }
    const row = this.#ring.table.length - 1;
    this.#fingers.forEach((finger, i) => this.#panel.showFlags(i, finger.flags(row)));
    this.#panel.showState(state);
    this.playback.request();
  }

  /** Shows an error instead of further data. */
  fail(error: string): void {
    this.#panel.notice(error);
  }

  /** Stops updating the figures and frees the scene's memory: browsers limit a page to about 16 WebGL contexts. */
  close(): void {
    clearInterval(this.#refresh);
    for (const canvas of this.element.querySelectorAll("canvas"))
      canvas.getContext("webgl2")?.getExtension("WEBGL_lose_context")?.loseContext();
  }
}
