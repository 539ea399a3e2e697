/** Tooltip with information about a point. */
import { make } from "../ui/dom";

export class Tooltip {
  readonly #box = make("div", { class: "tooltip", role: "status", hidden: "" });
  readonly #over: HTMLElement;

  constructor(over: HTMLElement) {
    this.#over = over;
    over.append(this.#box);
  }

  /** Shows lines next to a position of the panel, in px from its left and top. */
  show(lines: string[], left: number, top: number): void {
    this.#box.replaceChildren(...lines.map((line) => make("div", {}, line)));
    this.#box.hidden = false;
    // Place it towards the middle so that it is not clipped.
    const { clientWidth: width, clientHeight: height } = this.#over;
    const [x, y] = [
      left > width / 2 ? "calc(-100% - 12px)" : "12px",
      top > height / 2 ? "calc(-100% - 12px)" : "12px",
    ];
    this.#box.style.left = `${left}px`;
    this.#box.style.top = `${top}px`;
    this.#box.style.transform = `translate(${x}, ${y})`;
  }

  hide(): void {
    this.#box.hidden = true;
  }

  /** Copies text to the clipboard. If the browser denies access, shows the text for selection. */
  async copy(text: string, left: number, top: number): Promise<void> {
    try {
      await navigator.clipboard.writeText(text);
      this.show([text, "Copied"], left, top);
    } catch {
      this.show([text, "Copy failed; select the text here"], left, top);
    }
  }
}
