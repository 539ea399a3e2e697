/** Shows the forces on the reader's fingertip, and its flags. */
import { make, setText } from "../src/ui/dom";
import type { Felt } from "./protocol";

const AXES = ["Fx", "Fy", "Fz", "Mx", "My", "Mz"];
const FLAGS = ["touch", "slip", "over"] as const;

export class FeltView {
  readonly element: HTMLElement;
  readonly #force = make("span", { class: "force" });
  readonly #flags = FLAGS.map((name) => make("span", { class: `flag flag-${name}` }));

  constructor() {
    this.element = make("p", { class: "felt", hidden: "" }, this.#force, ...this.#flags);
  }

  show(felt: Felt | undefined): void {
    this.element.hidden = !felt;
    if (!felt) return;
    setText(this.#force, felt.kind === "wrench" ? wrenchText(felt) : elementsText(felt));
    for (const [k, name] of FLAGS.entries()) {
      const flag = this.#flags[k];
      if (!flag) continue;
      flag.hidden = felt.kind === "wrench";
      const raised = felt.kind === "elements" && felt[name];
      flag.classList.toggle("raised", raised);
      setText(flag, `${name.toUpperCase()} ${raised ? "on" : "off"}`);
    }
  }
}

function elementsText({ grasp_force, invalid }: Felt & { kind: "elements" }): string {
  const missing = invalid > 0 ? ` (${invalid} elements dark or saturated)` : "";
  return `Grasp force ${grasp_force.toFixed(3)} N${missing}`;
}

function wrenchText({ components, valid }: Felt & { kind: "wrench" }): string {
  const shown = components.flatMap((value, k) => {
    if (value === null) return [];
    return [k < 3 ? `${AXES[k]} ${value.toFixed(3)} N` : `${AXES[k]} ${(1e3 * value).toFixed(1)} N mm`];
  });
  if (shown.length === 0) return "No force: too many elements are dark or saturated";
  return shown.join(", ") + (valid ? "" : " (unlike the images of the calibration)");
}
