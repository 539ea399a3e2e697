/** Header of a live page: state of the hand, flags, and the buttons for stop and resume. */
import type { LiveState } from "../page_data";
import { FLAG_NAMES, type FingerColumns } from "../run";
import { button, make, setText } from "../ui/dom";

export class LivePanel {
  readonly element: HTMLElement;
  readonly #state = make(
    "p",
    { class: "live-state", role: "status", "aria-live": "polite" },
    "Waiting for the hand.",
  );
  readonly #answer = make("p", { class: "live-answer", role: "status", "aria-live": "polite" });
  readonly #notice = make("p", { class: "live-notice", role: "alert", hidden: "" });
  readonly #stop: HTMLButtonElement;
  readonly #resume: HTMLButtonElement;
  readonly #chips: [bit: number, chip: HTMLElement][][];

  constructor(fingers: FingerColumns[], orders: boolean, order: (which: "stop" | "resume") => void) {
    this.#stop = button("Stop", "Stop the hand (S)", () => order("stop"));
    this.#resume = button("Resume", "Resume the hand", () => order("resume"));
    this.#stop.className = "stop";
    this.#resume.className = "resume";
    this.#chips = fingers.map(() =>
      FLAG_NAMES.map(([bit, name]) => [bit, make("span", { class: `chip ${name}` }, name)]),
    );
    const rows = fingers.map(({ finger }, i) =>
      make("div", { class: "live-finger" }, finger.name, ...(this.#chips[i] ?? []).map(([, chip]) => chip)),
    );
    const buttons = orders
      ? make("div", { class: "orders" }, this.#stop, this.#resume)
      : make("p", { class: "note" }, "View only: this page cannot stop the hand.");
    const words = make("div", { class: "live-words" }, this.#state, this.#answer);
    this.element = make(
      "section",
      { class: "live", "aria-label": "State of the hand" },
      this.#notice,
      words,
      buttons,
    );
    this.element.append(make("div", { class: "live-fingers" }, ...rows));
    this.connected(false);
  }

  /** Shows the flags of a finger immediately, without waiting for an animation frame. */
  showFlags(finger: number, flags: number): void {
    for (const [bit, chip] of this.#chips[finger] ?? []) {
      const on = (flags & bit) !== 0;
      if (chip.classList.contains("on") === on) continue;
      chip.classList.toggle("on", on);
      chip.setAttribute("aria-label", `${chip.textContent} ${on ? "on" : "off"}`);
    }
  }

  showState({ state, stopped, answer, over }: LiveState): void {
    setText(this.#state, over ? `${state} No further data.` : state);
    this.#state.classList.toggle("stopped", stopped);
    setText(this.#answer, answer ?? "");
    this.#resume.disabled = !stopped || over;
    this.#stop.disabled = over;
  }

  /** Shows a warning about the data; an empty text hides it. */
  notice(text: string): void {
    setText(this.#notice, text);
    this.#notice.hidden = text === "";
    this.element.classList.toggle("stale", text !== "");
  }

  connected(there: boolean): void {
    this.#stop.disabled = !there;
    if (!there) this.#resume.disabled = true;
  }
}
