/** Number fields for the thresholds of the flags. */
import { make } from "../src/ui/dom";
import type { Thresholds } from "./protocol";

/** Fields with the thresholds of the experiment `cap-closing`. */
const FIELDS: [keyof Thresholds, string, string][] = [
  ["touch", "Touch threshold F1 (N)", "0.1"],
  ["over", "Over threshold F2 (N)", "0.505"],
  ["slip", "Slip threshold dr (N/s)", "6.5"],
];

export class ThresholdFields {
  readonly element: HTMLElement;
  readonly #inputs: [keyof Thresholds, HTMLInputElement][];

  /** Calls `changed` when the reader sets a threshold. */
  constructor(changed: () => void) {
    this.#inputs = FIELDS.map(([name, , value]) => [
      name,
      make("input", { type: "number", id: `threshold-${name}`, min: "0", step: "any", value }),
    ]);
    const rows = FIELDS.flatMap(([name, label], k) => [
      make("label", { for: `threshold-${name}` }, label),
      this.#inputs[k]?.[1] ?? "",
    ]);
    this.element = make("div", { class: "thresholds", hidden: "" }, ...rows);
    this.element.addEventListener("change", changed);
  }

  /** The thresholds. An invalid field is reset to its default. */
  values(): Thresholds {
    const values = this.#inputs.map(([name, input]) => {
      if (!(input.valueAsNumber >= 0)) input.value = input.defaultValue;
      return [name, input.valueAsNumber];
    });
    return Object.fromEntries(values) as Thresholds;
  }
}
