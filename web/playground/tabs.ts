/** Tabs after the ARIA pattern: arrow keys move between them. */
import { make } from "../src/ui/dom";

export class Tabs {
  readonly element: HTMLElement;
  readonly #bar = make("div", { class: "tabs", role: "tablist", "aria-label": "Parts of the playground" });
  readonly #tabs: { name: string; tab: HTMLButtonElement; panel: HTMLElement }[] = [];

  constructor() {
    this.element = make("div", {}, this.#bar);
    this.#bar.addEventListener("keydown", ({ key }) => {
      const by = { ArrowRight: 1, ArrowLeft: -1 }[key];
      const now = this.#tabs.findIndex(({ tab }) => tab === document.activeElement);
      const next = by && this.#tabs.at((now + by) % this.#tabs.length);
      if (!next) return;
      this.open(next.name);
      next.tab.focus();
    });
  }

  add(name: string, content: HTMLElement): void {
    const id = `tab-${this.#tabs.length}`;
    const tab = make("button", { type: "button", role: "tab", id, "aria-controls": `${id}-panel` }, name);
    const panel = make(
      "div",
      { class: "tab", role: "tabpanel", id: `${id}-panel`, "aria-labelledby": id },
      content,
    );
    tab.addEventListener("click", () => this.open(name));
    this.#tabs.push({ name, tab, panel });
    this.#bar.append(tab);
    this.element.append(panel);
  }

  open(name: string): void {
    for (const { name: own, tab, panel } of this.#tabs) {
      const selected = own === name;
      tab.setAttribute("aria-selected", String(selected));
      tab.tabIndex = selected ? 0 : -1;
      panel.hidden = !selected;
    }
  }
}
