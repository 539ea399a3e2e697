/** The table of all tracked markers. */
import { NUMBERS } from "./markers";

/** Maximum number of values in the table: ten minutes of 60 markers at 30 images a second. */
const MOST = 9e6;
const COLUMNS = [
  "time,marker,column_px,row_px,column_displacement_px,row_displacement_px,confidence",
  "force_x_n,force_y_n,force_z_n",
].join(",");

export class MarkerTable {
  #images: { time: number; markers: Float32Array }[] = [];
  #count = 0;

  /** Number of images in the table. */
  get images(): number {
    return this.#images.length;
  }

  /** `true` if the table is full. */
  get full(): boolean {
    return this.#count >= MOST;
  }

  /** Adds the numbers of all markers in the image at `time` (s). */
  add(time: number, markers: Float32Array): void {
    if (this.full) return;
    this.#images.push({ time, markers });
    this.#count += markers.length;
  }

  clear(): void {
    this.#images = [];
    this.#count = 0;
  }

  /** The table as CSV; cells of unknown forces are empty. */
  csv(): Blob {
    const parts = [`${COLUMNS}\n`];
    for (const { time, markers } of this.#images) {
      const lines: string[] = [];
      for (let marker = 0; marker * NUMBERS < markers.length; marker++) {
        const numbers = markers.subarray(marker * NUMBERS, (marker + 1) * NUMBERS);
        const texts = [...numbers].map((number) => (Number.isNaN(number) ? "" : number.toFixed(4)));
        lines.push([time.toFixed(4), marker, ...texts].join(","));
      }
      parts.push(`${lines.join("\n")}\n`);
    }
    return new Blob(parts, { type: "text/csv" });
  }
}
