/** Draws tracked markers: a dot and an arrow each, and a heat map of their displacement. */

/** Numbers of a marker: column, row, displacement along both (px), confidence, and force x, y, z (N). */
export const NUMBERS = 8;
/** Length of an arrow relative to the displacement. */
const ARROW = 3;
/** Displacement of the warmest colour (px). */
export const WARM = 12;
/** Confidence below which a marker counts as lost. */
const LOST = 0.3;
/** Size of a cell of the heat map (px). */
const CELL = 6;
/** Largest opacity of the heat map. */
const OPACITY = 0.65;

interface Marker {
  x: number;
  y: number;
  dx: number;
  dy: number;
  lost: boolean;
}

function* each(markers: Float32Array): Generator<Marker> {
  for (let k = 0; k + NUMBERS <= markers.length; k += NUMBERS) {
    const [x = 0, y = 0, dx = 0, dy = 0, confidence = 0] = markers.subarray(k, k + 5);
    yield { x, y, dx, dy, lost: confidence < LOST };
  }
}

/** Hue of a displacement, blue to red (degrees). */
function hue(displacement: number): number {
  return 210 * (1 - Math.min(1, displacement / WARM));
}

export function drawMarkers(context: CanvasRenderingContext2D, markers: Float32Array): void {
  context.lineWidth = 1.5;
  for (const { x, y, dx, dy, lost } of each(markers)) {
    context.strokeStyle = context.fillStyle = lost ? "#888888" : `hsl(${hue(Math.hypot(dx, dy))} 90% 55%)`;
    context.beginPath();
    context.arc(x, y, 3, 0, 2 * Math.PI);
    if (lost) context.stroke();
    else context.fill();
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x + ARROW * dx, y + ARROW * dy);
    context.stroke();
  }
}

/** Heat map of the displacement, interpolated between markers with Gaussian weights. */
export class HeatMap {
  readonly #small = document.createElement("canvas");
  #weights = new Float32Array(0);
  #sums = new Float32Array(0);

  draw(context: CanvasRenderingContext2D, markers: Float32Array): void {
    const { width, height } = context.canvas;
    const [columns, rows] = [Math.ceil(width / CELL), Math.ceil(height / CELL)];
    this.#sum(markers, columns, rows, width * height);
    const image = new ImageData(columns, rows);
    for (const [cell, weight] of this.#weights.entries()) {
      if (weight < 0.02) continue;
      const [red, green, blue] = rgb(hue((this.#sums[cell] ?? 0) / weight));
      image.data.set([red, green, blue, 255 * OPACITY * Math.min(1, 2 * weight)], 4 * cell);
    }
    [this.#small.width, this.#small.height] = [columns, rows];
    this.#small.getContext("2d")?.putImageData(image, 0, 0);
    context.drawImage(this.#small, 0, 0, columns * CELL, rows * CELL);
  }

  /** Sums weights, and weighted displacements, in each cell. `area` is that of the image (px²). */
  #sum(markers: Float32Array, columns: number, rows: number, area: number): void {
    if (this.#weights.length !== columns * rows) {
      this.#weights = new Float32Array(columns * rows);
      this.#sums = new Float32Array(columns * rows);
    }
    this.#weights.fill(0);
    this.#sums.fill(0);
    // Standard deviation of the Gaussian: 0.6 times the mean marker spacing (px); `reach` is its cut-off in cells.
    const spread = 0.6 * Math.sqrt(area / Math.max(1, markers.length / NUMBERS));
    const reach = Math.ceil((2.2 * spread) / CELL);
    for (const { x, y, dx, dy, lost } of each(markers)) {
      if (lost) continue;
      const displacement = Math.hypot(dx, dy);
      const [column, row] = [Math.floor(x / CELL), Math.floor(y / CELL)];
      for (let r = Math.max(0, row - reach); r <= Math.min(rows - 1, row + reach); r++) {
        for (let c = Math.max(0, column - reach); c <= Math.min(columns - 1, column + reach); c++) {
          const distance = Math.hypot((c + 0.5) * CELL - x, (r + 0.5) * CELL - y) / spread;
          const weight = Math.exp(-0.5 * distance * distance);
          const cell = r * columns + c;
          this.#weights[cell] = (this.#weights[cell] ?? 0) + weight;
          this.#sums[cell] = (this.#sums[cell] ?? 0) + weight * displacement;
        }
      }
    }
  }
}

/** A saturated colour of `hue` (degrees, up to 240) as red, green and blue. */
function rgb(hue: number): [number, number, number] {
  const channel = (n: number) => {
    const k = (n + hue / 30) % 12;
    return Math.round(255 * (0.55 - 0.4 * Math.max(-1, Math.min(k - 3, 9 - k, 1))));
  };
  return [channel(0), channel(8), channel(4)];
}
