/** Values of an experiment that a slider changes. */
import { significant } from "../src/format";
import { make, setText } from "../src/ui/dom";
import type { Experiment } from "./protocol";

/** A value that a reader may change, as one or more keys of the experiment. */
interface Slider {
  id: string;
  label: string;
  /** Unit on the page, and the factor from the experiment's unit. */
  unit: string;
  scale: number;
  /** Keys that are set, the first of which is shown. The others keep their ratio to it. */
  keys: string[];
  /** Range as factors of the experiment's value, or absolute values if the experiment's value is 0. */
  range: [number, number];
  /** Index in the array of the key's value, if it is one. */
  index?: number;
}

const SLIDERS: Slider[] = [
  {
    id: "friction",
    label: "Friction of the rubber",
    unit: "",
    scale: 1,
    keys: ["sim.feeler.static_friction", "sim.feeler.kinetic_friction"],
    range: [0.2, 1.6],
  },
  {
    id: "stiffness",
    label: "Stiffness of a feeler",
    unit: "N/m",
    scale: 1,
    keys: ["sim.feeler.normal_stiffness", "sim.feeler.shear_stiffness"],
    range: [0.4, 2.5],
  },
  {
    id: "radius",
    label: "Radius of the cap",
    unit: "mm",
    scale: 1e3,
    keys: ["sim.object.cap.shape.cylinder.radius"],
    range: [0.7, 1.4],
  },
  {
    id: "off-centre",
    label: "Cap off centre",
    unit: "mm",
    scale: 1e3,
    keys: ["sim.object.cap.offset"],
    index: 0,
    range: [0, 0.003],
  },
  {
    id: "slip-threshold",
    label: "Slip threshold dr",
    unit: "N/s",
    scale: 1,
    keys: ["control.slip_threshold"],
    range: [0.2, 5],
  },
  {
    id: "touch-force",
    label: "Touch threshold F1",
    unit: "N",
    scale: 1,
    keys: ["control.touch_force"],
    range: [0.2, 3],
  },
  {
    id: "over-force",
    label: "Over threshold F2",
    unit: "N",
    scale: 1,
    keys: ["control.over_force"],
    range: [0.5, 3],
  },
];

/** Value of the dotted `key` in an experiment's configuration. */
function lookUp(config: object, key: string): unknown {
  return key
    .split(".")
    .reduce<unknown>((table, part) => (table as Record<string, unknown> | undefined)?.[part], config);
}

function numberAt(config: object, key: string, index: number | undefined): number | undefined {
  const value = lookUp(config, key);
  const number = index === undefined ? value : (value as number[] | undefined)?.[index];
  return typeof number === "number" ? number : undefined;
}

/** Sliders for the values that an experiment has. */
export class Sliders {
  readonly element = make("div", { class: "sliders" });
  #rows: { slider: Slider; base: number; input: HTMLInputElement }[] = [];
  #config: object = {};

  /** Calls `changed` when the reader moves a slider. */
  constructor(readonly changed: (id: string) => void) {}

  /** Shows the sliders of `experiment` at its values. */
  show({ config }: Experiment): void {
    this.#config = config;
    this.#rows = SLIDERS.flatMap((slider) => {
      const base = numberAt(config, slider.keys[0] ?? "", slider.index);
      return base === undefined ? [] : [{ slider, base, input: this.#input(slider, base) }];
    });
    this.element.replaceChildren(...this.#rows.map((row) => this.#row(row)));
  }

  #input(slider: Slider, base: number): HTMLInputElement {
    const factor = base === 0 ? 1 : base;
    const [low, high] = slider.range.map((bound) => bound * factor) as [number, number];
    const input = make("input", { type: "range", id: `slider-${slider.id}` });
    Object.assign(input, { min: String(low), max: String(high), step: "any", value: String(base) });
    return input;
  }

  #row({ slider, base, input }: { slider: Slider; base: number; input: HTMLInputElement }): HTMLElement {
    const output = make("output", { for: input.id });
    const show = () => {
      const shown = `${significant(valueOf(input, base) * slider.scale)}${slider.unit && `\u00a0${slider.unit}`}`;
      setText(output, shown);
      input.setAttribute("aria-valuetext", shown);
    };
    input.addEventListener("input", () => {
      show();
      this.changed(slider.id);
    });
    show();
    return make("div", { class: "slider" }, make("label", { for: input.id }, slider.label), output, input);
  }

  /** Settings of the moved sliders, as `KEY=VALUE`. */
  settings(): string[] {
    return this.#rows.flatMap(({ slider, base, input }) => {
      const value = valueOf(input, base);
      if (value === base) return [];
      return slider.keys.map((key) => `${key}=${this.#text(slider, key, value, base)}`);
    });
  }

  #text(slider: Slider, key: string, value: number, base: number): string {
    const own = numberAt(this.#config, key, slider.index) ?? 0;
    const changed = rounded(base === 0 ? value : (own * value) / base);
    if (slider.index === undefined) return changed;
    const list = [...(lookUp(this.#config, key) as number[])].map(float);
    list[slider.index] = changed;
    return `[${list.join(", ")}]`;
  }

  /** Value of a slider relative to the experiment's. */
  factor(id: string): number {
    const row = this.#rows.find(({ slider }) => slider.id === id);
    return row && row.base !== 0 ? valueOf(row.input, row.base) / row.base : 1;
  }

  /** Moves the sliders to `settings` as far as they have their keys; returns the remaining settings. */
  apply(settings: string[]): string[] {
    const rest = new Map(settings.map((setting) => setting.split(/=(.*)/s, 2) as [string, string]));
    for (const { slider, base, input } of this.#rows) {
      const [key = "", ...others] = slider.keys;
      const text = rest.get(key);
      if (text === undefined) continue;
      const list = text.replace(/[[\]\s]/g, "").split(",");
      const value = Number(list[slider.index ?? 0]);
      if (!Number.isFinite(value) || value < Number(input.min) - 1e-12 || value > Number(input.max) + 1e-12)
        continue;
      const expected = others.every((other) => rest.get(other) === this.#text(slider, other, value, base));
      if (!expected) continue;
      input.value = String(value);
      input.dispatchEvent(new Event("input"));
      for (const used of slider.keys) rest.delete(used);
    }
    return [...rest].map(([key, value]) => `${key}=${value}`);
  }
}

/** The slider's value, of four significant digits; exactly `base` in its original position. */
function valueOf(input: HTMLInputElement, base: number): number {
  const value = Number(input.value);
  return value === base ? base : Number(rounded(value));
}

/** A number of four significant digits, as a TOML float. */
function rounded(value: number): string {
  return float(Number(value.toPrecision(4)));
}

function float(value: number): string {
  const text = String(value);
  return /[.e]/.test(text) ? text : `${text}.0`;
}
