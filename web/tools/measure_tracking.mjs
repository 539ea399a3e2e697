// Measures how many images of 640 x 480 px with 63 markers the playground's program tracks in a second.
// usage: npm run playground && node tools/measure_tracking.mjs
import { readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { Fingertip, initSync } from "../out/wasm/feeler_wasm.js";

const [WIDTH, HEIGHT, PITCH, IMAGES] = [640, 480, 60, 300];
const [COLUMNS, ROWS] = [9, 7];

/** Dark spots on a bright ground, displaced by `dx` (px) along the rows; pixels of a canvas. */
function image(dx) {
  const pixels = new Uint8Array(4 * WIDTH * HEIGHT).fill(180);
  for (let n = 0; n < COLUMNS * ROWS; n++) {
    const x = 80 + PITCH * (n % COLUMNS) + dx;
    const y = 60 + PITCH * Math.floor(n / COLUMNS);
    for (let row = Math.ceil(y - 12); row <= y + 12; row++) {
      for (let column = Math.ceil(x - 12); column <= x + 12; column++) {
        const gray = 180 - 140 * Math.exp(-((column - x) ** 2 + (row - y) ** 2) / 50);
        pixels.fill(gray, 4 * (row * WIDTH + column), 4 * (row * WIDTH + column) + 3);
      }
    }
  }
  return pixels;
}

initSync({
  module: readFileSync(fileURLToPath(new URL("../out/wasm/feeler_wasm_bg.wasm", import.meta.url))),
});
const fingertip = new Fingertip(image(0), WIDTH, HEIGHT);
const moved = Array.from({ length: IMAGES }, (_, n) => 8 * Math.sin(n / 5));
const images = moved.map(image);
const start = performance.now();
let tracked;
for (const pixels of images) tracked = fingertip.track(pixels, 0);
const seconds = (performance.now() - start) / 1000;
const errors = Array.from({ length: fingertip.markers() }, (_, n) =>
  Math.abs(tracked[8 * n + 2] - moved.at(-1)),
);
console.log(`${fingertip.markers()} markers: ${(IMAGES / seconds).toFixed(0)} images/s`);
console.log(`largest error of the displacement in the last image: ${Math.max(...errors).toFixed(3)} px`);
