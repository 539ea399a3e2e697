/** The form that describes a run. */
import { button, make, setText } from "../src/ui/dom";
import type { Catalogue, Experiment } from "./protocol";
import { lawOf, type PageSettings, withLaw } from "./settings_link";
import { Sliders } from "./sliders";

/** Choice of the experiment's own law, or of no law. */
const NONE = "";

export class RunForm {
  readonly element: HTMLFormElement;
  readonly sliders: Sliders;
  readonly #catalogue: Catalogue;
  readonly #experiment = make("select", { id: "experiment" });
  readonly #about = make("p", { class: "note" });
  readonly #law = make("select", { id: "law" });
  readonly #compare = make("select", { id: "compare" });
  readonly #seed = make("input", { id: "seed", type: "number", min: "0", step: "1", required: "" });
  readonly #sensing = make("select", { id: "sensing" });
  /** Settings that no control of the form shows. */
  #rest: string[] = [];

  /** Calls `run` when the reader starts a run, and `moved` with the slider that was moved. */
  constructor(catalogue: Catalogue, run: () => void, moved: (slider: string) => void) {
    this.#catalogue = catalogue;
    this.sliders = new Sliders(moved);
    this.#experiment.append(...catalogue.experiments.map(({ name }) => option(name, name)));
    this.#sensing.append(
      option("direct", "forces directly (fast)"),
      option("image", "through rendered pictures"),
    );
    this.#experiment.addEventListener("change", () => this.#choose());
    const start = make("button", { type: "submit", class: "primary" }, "Run");
    this.element = make(
      "form",
      { class: "run-form", "aria-label": "Settings of the run", novalidate: "" },
      field("Experiment", this.#experiment),
      this.#about,
      field("Control law", this.#law),
      field("Compare with", this.#compare),
      field("Forces are sensed", this.#sensing),
      field("Seed", this.#seed),
      this.sliders.element,
      make(
        "div",
        { class: "orders" },
        start,
        button("Reset", "Reset all settings to the experiment's", () => this.#choose()),
      ),
    );
    this.element.addEventListener("submit", (event) => {
      event.preventDefault();
      run();
    });
    this.#choose();
  }

  get experiment(): Experiment {
    const chosen = this.#catalogue.experiments.find(({ name }) => name === this.#experiment.value);
    return chosen ?? (this.#catalogue.experiments[0] as Experiment);
  }

  /** Shows the chosen experiment's own values. */
  #choose(): void {
    const { description, law, seed, sensing } = this.experiment;
    setText(this.#about, description);
    this.#law.replaceChildren(option(NONE, `${law} (of the experiment)`));
    this.#law.append(
      ...this.#catalogue.laws.filter((other) => other !== law).map((other) => option(other, other)),
    );
    this.#compare.replaceChildren(option(NONE, "no other law"));
    this.#compare.append(...this.#catalogue.laws.map((other) => option(other, other)));
    this.#seed.value = String(seed);
    this.#sensing.value = sensing;
    this.#rest = [];
    this.sliders.show(this.experiment);
  }

  settings(): PageSettings {
    return {
      experiment: this.experiment.name,
      seed: Number(this.#seed.value),
      sensing: this.#sensing.value === "image" ? "image" : "direct",
      set: withLaw([...this.sliders.settings(), ...this.#rest], this.#law.value),
      compare: this.#compare.value,
    };
  }

  /** Shows `settings`; values that it lacks are the experiment's. */
  apply({ experiment, seed, sensing, set = [], compare }: Partial<PageSettings>): void {
    if (experiment && this.#catalogue.experiments.some(({ name }) => name === experiment)) {
      this.#experiment.value = experiment;
    }
    this.#choose();
    if (seed !== undefined) this.#seed.value = String(seed);
    if (sensing) this.#sensing.value = sensing;
    if (compare && this.#catalogue.laws.includes(compare)) this.#compare.value = compare;
    const law = lawOf(set);
    const isKnown = this.#catalogue.laws.includes(law);
    if (isKnown) this.#law.value = law === this.experiment.law ? NONE : law;
    this.#rest = this.sliders.apply(isKnown ? withLaw(set, NONE) : set);
  }
}

function option(value: string, text: string): HTMLOptionElement {
  return make("option", { value }, text);
}

function field(label: string, control: HTMLElement): HTMLElement {
  return make("div", { class: "field" }, make("label", { for: control.id }, label), control);
}
