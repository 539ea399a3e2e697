/** The head of a live page: what the hand is about, its flags, and the buttons that stop it and let it go on. */
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
    this.#resume = button("Resume", "Let the hand go on", () => order("resume"));
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
      : make("p", { class: "note" }, "This page watches: nobody here can be told to stop.");
    const words = make("div", { class: "live-words" }, this.#state, this.#answer);
    this.element = make(
      "section",
      { class: "live", "aria-label": "The hand now" },
      this.#notice,
      words,
      buttons,
    );
    this.element.append(make("div", { class: "live-fingers" }, ...rows));
    this.connected(false);
  }

  /** Shows the flags of a finger, at once: it does not wait for a frame. */
  showFlags(finger: number, flags: number): void {
    for (const [bit, chip] of this.#chips[finger] ?? []) {
      const on = (flags & bit) !== 0;
      if (chip.classList.contains("on") === on) continue;
      chip.classList.toggle("on", on);
      chip.setAttribute("aria-label", `${chip.textContent} ${on ? "on" : "off"}`);
    }
  }

  showState({ state, stopped, answer, over }: LiveState): void {
    setText(this.#state, over ? `${state} No more rows come.` : state);
    this.#state.classList.toggle("stopped", stopped);
    setText(this.#answer, answer ?? "");
    this.#resume.disabled = !stopped || over;
    this.#stop.disabled = over;
  }

  /** Says what is wrong with the data, or nothing. */
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
