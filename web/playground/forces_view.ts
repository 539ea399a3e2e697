/** Shows the forces on the reader's fingertip, and its flags. */
import { make, setText } from "../src/ui/dom";
import type { Sensed } from "./protocol";

const AXES = ["Fx", "Fy", "Fz", "Mx", "My", "Mz", "x", "y"];
const FLAGS = ["touch", "slip", "over"] as const;

export class ForcesView {
  readonly element: HTMLElement;
  readonly #force = make("span", { class: "force" });
  readonly #flags = FLAGS.map((name) => make("span", { class: `flag flag-${name}` }));

  constructor() {
    this.element = make("p", { class: "forces", hidden: "" }, this.#force, ...this.#flags);
  }

  show(sensed: Sensed | undefined): void {
    this.element.hidden = !sensed;
    if (!sensed) return;
    setText(this.#force, sensed.kind === "wrench" ? wrenchText(sensed) : elementsText(sensed));
    for (const [k, name] of FLAGS.entries()) {
      const flag = this.#flags[k];
      if (!flag) continue;
      flag.hidden = sensed.kind === "wrench";
      const raised = sensed.kind === "elements" && sensed[name];
      flag.classList.toggle("raised", raised);
      setText(flag, `${name.toUpperCase()} ${raised ? "on" : "off"}`);
    }
  }
}

function elementsText({ grasp_force, invalid }: Sensed & { kind: "elements" }): string {
  const missing = invalid > 0 ? ` (${invalid} elements dark or saturated)` : "";
  return `Grasp force ${grasp_force.toFixed(3)} N${missing}`;
}

function wrenchText({ components, valid }: Sensed & { kind: "wrench" }): string {
  const shown = components.flatMap((value, k) => {
    if (value === null) return [];
    const unit = k < 6 ? "N mm" : "mm";
    return [k < 3 ? `${AXES[k]} ${value.toFixed(3)} N` : `${AXES[k]} ${(1e3 * value).toFixed(1)} ${unit}`];
  });
  if (shown.length === 0) return "No force: too many elements are dark or saturated";
  return shown.join(", ") + (valid ? "" : " (unlike the images of the calibration)");
}
