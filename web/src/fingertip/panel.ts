/** Panel of a fingertip: camera view, flags and forces. */
import { quantity, significant } from "../format";
import { FLAG_NAMES, type FingerColumns } from "../run";
import { fingerColour } from "../ui/colours";
import { make, setText } from "../ui/dom";
import { isDark, onTheme } from "../ui/theme";
import { ARROW_SCALE, Picture } from "./picture";

/** Force of the legend's arrow (N). */
const LEGEND_FORCE = 0.1;

export class FingertipPanel {
  readonly element: HTMLElement;
  readonly #columns: FingerColumns;
  readonly #canvas: HTMLCanvasElement;
  readonly #picture: Picture;
  readonly #chips: [bit: number, chip: HTMLElement][];
  readonly #numbers = new Map<string, HTMLElement>();
  #row = 0;

  constructor(columns: FingerColumns) {
    const { name } = columns.finger;
    this.#columns = columns;
    this.#canvas = make("canvas", { role: "img" });
    this.#picture = new Picture(this.#canvas, columns);
    this.#chips = FLAG_NAMES.map(([bit, flag]) => [bit, make("span", { class: `chip ${flag}` }, flag)]);
    const swatch = make("i", { class: "finger-swatch" });
    const paint = () => (swatch.style.background = fingerColour(columns.number, isDark()));
    onTheme(paint);
    paint();
    const heading = make("h3", {}, swatch, name);
    const chips = make("div", { class: "chips" }, ...this.#chips.map(([, chip]) => chip));
    const picture = make("div", { class: "fingertip-picture" }, this.#canvas);
    const beside = make("div", { class: "fingertip-numbers" }, heading, chips, this.#table(), legend());
    this.element = make(
      "section",
      { class: "fingertip", "aria-label": `Fingertip of ${name}` },
      picture,
      beside,
    );
    new ResizeObserver(() => this.#fit(picture.clientWidth)).observe(picture);
  }

  show(row: number): void {
    this.#row = row;
    this.#picture.draw(row);
    this.showFlags(this.#columns.flags(row));
    this.#showNumbers(row);
  }

  showFlags(flags: number): void {
    for (const [bit, chip] of this.#chips) {
      const on = (flags & bit) !== 0;
      if (chip.classList.contains("on") === on) continue;
      chip.classList.toggle("on", on);
      chip.setAttribute("aria-label", `${chip.textContent} ${on ? "on" : "off"}`);
    }
  }

  #table(): HTMLElement {
    const body = make("tbody");
    const ofElements = ["Normal force", "Tangential force", "Maximum compression", "Touching elements"];
    const ofContact = this.#columns.hasContact ? ["Contact area", "Torsion", "Sliding"] : [];
    for (const name of [...ofElements, ...ofContact]) {
      const value = make("td", { class: "number" });
      this.#numbers.set(name, value);
      body.append(make("tr", {}, make("th", { scope: "row" }, name), value));
    }
    return make("table", {}, body);
  }

  #showNumbers(row: number): void {
    const { elements, touchForce } = this.#columns.finger;
    const { forces } = this.#columns;
    let [normal, hardest, touching, x, y, z] = [0, 0, 0, 0, 0, 0];
    for (let i = 0; i < elements.length; i++) {
      const compression = this.#columns.compression(row, i);
      normal += compression;
      hardest = Math.max(hardest, compression);
      if (compression > touchForce) touching++;
      const [fx, fy] = [forces?.at(row, 3 * i) || 0, forces?.at(row, 3 * i + 1) || 0];
      const along = tangent(elements[i]?.rotation ?? [0, 0, 0, 1], fx, fy);
      [x, y, z] = [x + along[0], y + along[1], z + along[2]];
    }
    this.#write("Normal force", quantity(normal, "N"));
    this.#write("Tangential force", quantity(Math.hypot(x, y, z), "N"));
    this.#write("Maximum compression", quantity(hardest, "N"));
    this.#write("Touching elements", `${touching} of ${elements.length}`);
    const contact = this.#columns.contact(row);
    const [long, short] = contact?.axes.map((axis) => Math.hypot(...axis)) ?? [];
    const area = Math.PI * (long ?? NaN) * (short ?? NaN);
    this.#write("Contact area", quantity(area, "mm²", 1e6));
    this.#write("Torsion", quantity(contact?.torsion ?? NaN, "N\u00a0mm", 1e3));
    this.#write("Sliding", quantity(contact?.sliding ?? NaN, "%", 100));
    this.#canvas.ariaLabel = `Camera view: ${touching} touching elements, ${significant(normal)} N in total.`;
  }

  #write(name: string, text: string): void {
    const place = this.#numbers.get(name);
    if (place) setText(place, text);
  }

  #fit(width: number): void {
    const pixels = Math.round(width * Math.min(devicePixelRatio, 2));
    if (pixels === 0 || pixels === this.#canvas.width) return;
    this.#canvas.width = this.#canvas.height = pixels;
    this.show(this.#row);
  }
}

/**
 * Transforms a tangential force from the element's frame to the finger's frame, using the first two columns of the
 * rotation.
 */
function tangent(
  [x, y, z, w]: [number, number, number, number],
  fx: number,
  fy: number,
): [number, number, number] {
  return [
    fx * (1 - 2 * (y * y + z * z)) + fy * 2 * (x * y - w * z),
    fx * 2 * (x * y + w * z) + fy * (1 - 2 * (x * x + z * z)),
    fx * 2 * (x * z - w * y) + fy * 2 * (y * z + w * x),
  ];
}

/** Legend of the camera view: an arrow of known force. Its length is in percent of the image's width (2 units). */
function legend(): HTMLElement {
  const length = ((100 * ARROW_SCALE * LEGEND_FORCE) / 2).toFixed(1);
  const arrow = make("i", { class: "arrow", style: `--length: ${length}` });
  return make(
    "p",
    { class: "note" },
    arrow,
    `tangential force ${significant(LEGEND_FORCE)}\u00a0N; spots grow with compression; pink: centre and area of contact`,
  );
}
