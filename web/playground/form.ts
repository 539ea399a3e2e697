/** The form that describes a run. */
import { button, make, setText } from "../src/ui/dom";
import type { Catalogue, Experiment } from "./protocol";
import { lawOf, type PageSettings, withLaw } from "./settings_link";
import { Sliders } from "./sliders";

/** Value of the options for the experiment's own law and for no comparison. */
const NONE = "";

export class RunForm {
  readonly element: HTMLFormElement;
  readonly sliders: Sliders;
  /** Control law of the chosen experiment. */
  ownLaw = "";
  readonly #catalogue: Catalogue;
  readonly #describe: (name: string) => Promise<Experiment>;
  readonly #experiment = make("select", { id: "experiment" });
  readonly #about = make("p", { class: "note" });
  readonly #law = make("select", { id: "law" });
  readonly #compare = make("select", { id: "compare" });
  readonly #seed = make("input", { id: "seed", type: "number", min: "0", step: "1", required: "" });
  readonly #sensing = make("select", { id: "sensing" });
  /** Disabled until the values of the chosen experiment are known. */
  readonly #start = make("button", { type: "submit", class: "primary" }, "Run");
  /** Settings that no control of the form shows. */
  #rest: string[] = [];

  /**
   * Calls `run` when the reader starts a run, and `moved` with the slider that was moved. The form is empty until
   * `apply`.
   */
  constructor(
    catalogue: Catalogue,
    describe: (name: string) => Promise<Experiment>,
    run: () => void,
    moved: (slider: string) => void,
  ) {
    this.#catalogue = catalogue;
    this.#describe = describe;
    this.sliders = new Sliders(moved);
    this.#experiment.append(...catalogue.experiments.map((name) => option(name, name)));
    this.#sensing.append(
      option("direct", "forces directly (fast)"),
      option("image", "through rendered pictures"),
    );
    this.#experiment.addEventListener("change", () => void this.#choose());
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
        this.#start,
        button("Reset", "Reset all settings to the experiment's", () => void this.#choose()),
      ),
    );
    this.element.addEventListener("submit", (event) => {
      event.preventDefault();
      run();
    });
  }

  /** Shows the chosen experiment's own values. Returns `false` if another is chosen meanwhile. */
  async #choose(): Promise<boolean> {
    const name = this.#experiment.value;
    this.#start.disabled = true;
    let experiment: Experiment;
    try {
      experiment = await this.#describe(name);
    } catch (error) {
      if (this.#experiment.value !== name) return false;
      this.#refuse(`${name}: ${error instanceof Error ? error.message : error}`);
      return false;
    }
    if (this.#experiment.value !== name) return false;
    this.#start.disabled = false;
    const { description, law, seed, sensing } = experiment;
    this.ownLaw = law;
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
    this.sliders.show(experiment);
    return true;
  }

  /** Disables the form and shows `reason`. */
  #refuse(reason: string): void {
    this.#start.disabled = true;
    setText(this.#about, reason);
    this.sliders.element.replaceChildren();
  }

  settings(): PageSettings {
    const set = [...this.sliders.settings(), ...this.#rest];
    const law = this.#law.value;
    return {
      experiment: this.#experiment.value,
      seed: Number(this.#seed.value),
      sensing: this.#sensing.value === "image" ? "image" : "direct",
      // Without a choice, a law that the form does not know remains, and the run refuses it.
      set: law === NONE ? set : withLaw(set, law),
      compare: this.#compare.value,
    };
  }

  /**
   * Shows `settings`; missing values are the experiment's. Returns `false` if the experiment is unknown, or another one
   * is chosen meanwhile.
   */
  async apply({ experiment, seed, sensing, set = [], compare }: Partial<PageSettings>): Promise<boolean> {
    if (experiment && !this.#catalogue.experiments.includes(experiment)) {
      this.#experiment.selectedIndex = -1;
      this.#refuse(`There is no built-in experiment "${experiment}"; choose another one.`);
      return false;
    }
    if (experiment) this.#experiment.value = experiment;
    if (!(await this.#choose())) return false;
    if (seed !== undefined) this.#seed.value = String(seed);
    if (sensing) this.#sensing.value = sensing;
    if (compare && this.#catalogue.laws.includes(compare)) this.#compare.value = compare;
    const law = lawOf(set);
    const isKnown = this.#catalogue.laws.includes(law);
    if (isKnown) this.#law.value = law === this.ownLaw ? NONE : law;
    this.#rest = this.sliders.apply(isKnown ? withLaw(set, NONE) : set);
    return true;
  }
}

function option(value: string, text: string): HTMLOptionElement {
  return make("option", { value }, text);
}

function field(label: string, control: HTMLElement): HTMLElement {
  return make("div", { class: "field" }, make("label", { for: control.id }, label), control);
}
