/** Controls of rumble and tone. */
import { make, setText } from "../ui/dom";
import { FULL_FORCES, type Settings } from "./settings";

export class FeelPanel {
  readonly element: HTMLElement;
  readonly #on = make("input", { type: "checkbox" });
  readonly #finger = make("select", { "aria-label": "Finger to feel" });
  readonly #fullForce = make("select", { "aria-label": "Grasp force at full strength" });
  readonly #status = make("p", { class: "feel-status", role: "status", "aria-live": "polite" });

  /** Calls `changed` with the new settings when the watcher changes one. */
  constructor(fingers: string[], settings: Settings, changed: (settings: Settings) => void) {
    this.#finger.append(make("option", { value: "" }, "strongest finger"));
    fingers.forEach((name, i) => this.#finger.append(make("option", { value: String(i) }, name)));
    for (const force of FULL_FORCES)
      this.#fullForce.append(make("option", { value: String(force) }, `${force} N`));
    this.#on.checked = settings.on;
    this.#finger.value = String(settings.finger ?? "");
    this.#fullForce.value = String(settings.fullForce);
    for (const control of [this.#on, this.#finger, this.#fullForce])
      control.addEventListener("change", () => changed(this.#settings()));
    this.element = make(
      "fieldset",
      { class: "feel" },
      make("legend", {}, "Feel"),
      make("label", { title: "Rumble and tone from grip and slip (F)" }, this.#on, " Rumble and tone"),
      make("label", {}, "of ", this.#finger),
      make("label", {}, "full at ", this.#fullForce),
      this.#status,
    );
  }

  #settings(): Settings {
    const finger = this.#finger.value === "" ? undefined : Number(this.#finger.value);
    return { on: this.#on.checked, finger, fullForce: Number(this.#fullForce.value) };
  }

  /** Switches on or off, as a click on the checkbox does. */
  toggle(): void {
    this.#on.click();
  }

  status(text: string): void {
    setText(this.#status, text);
  }
}
