/** What is said of a point beside the cursor. */
import { make } from "../ui/dom";

export class Tooltip {
  readonly #box = make("div", { class: "tooltip", role: "status", hidden: "" });
  readonly #over: HTMLElement;

  constructor(over: HTMLElement) {
    this.#over = over;
    over.append(this.#box);
  }

  /** Writes lines beside a place of the panel, px from its left and top. */
  show(lines: string[], left: number, top: number): void {
    this.#box.replaceChildren(...lines.map((line) => make("div", {}, line)));
    this.#box.hidden = false;
    // Towards the middle, so that nothing of it is outside.
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

  /** Puts a text into the clipboard; shows it for selecting where the browser does not allow that. */
  async copy(text: string, left: number, top: number): Promise<void> {
    try {
      await navigator.clipboard.writeText(text);
      this.show([text, "Copied"], left, top);
    } catch {
      this.show([text, "Not copied: select it here"], left, top);
    }
  }
}
