/** Legend above a panel: colour and name of each series, its value at the cursor, and a button that hides it. */
import type { Panel } from "../page_data";
import { make, setText } from "../ui/dom";
import { axisTitle, seriesColour } from "./style";

export class Legend {
  readonly element: HTMLElement;
  readonly #panel: Panel;
  readonly #values: HTMLElement[] = [];
  readonly #swatches: HTMLElement[] = [];

  constructor(panel: Panel, toggle: (series: number, shown: boolean) => void) {
    this.#panel = panel;
    this.element = make(
      "div",
      { class: "legend" },
      make("span", { class: "legend-title" }, axisTitle(panel.y)),
    );
    panel.series.forEach((series, i) => {
      const entry = this.#entry(series.name, i, toggle);
      // Unnamed series have no entry.
      if (series.name) this.element.append(entry);
    });
    this.paint();
  }

  /** Shows the formatted values of all series. */
  show(valueOf: (series: number) => string): void {
    this.#values.forEach((output, i) => setText(output, valueOf(i)));
  }

  paint(): void {
    this.#panel.series.forEach((series, i) => {
      const swatch = this.#swatches[i];
      if (!swatch) return;
      swatch.style.color = seriesColour(series);
      swatch.dataset.line = series.line;
    });
  }

  #entry(name: string, i: number, toggle: (series: number, shown: boolean) => void): HTMLElement {
    const swatch = make("i", { class: "swatch" });
    const value = make("output", { class: "legend-value" });
    const entry = make(
      "button",
      { type: "button", "aria-pressed": "true", title: "Show or hide" },
      swatch,
      name,
    );
    entry.addEventListener("click", () => {
      const shown = entry.getAttribute("aria-pressed") !== "true";
      entry.setAttribute("aria-pressed", String(shown));
      toggle(i, shown);
    });
    this.#values.push(value);
    this.#swatches.push(swatch);
    return make("span", { class: "legend-entry" }, entry, value);
  }
}
