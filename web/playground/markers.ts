/** Draws tracked markers: a dot each, coloured by displacement, and an arrow. */

/** Numbers of a marker: column, row, displacement along both (px), and confidence. */
export const NUMBERS = 5;
/** Length of an arrow relative to the displacement. */
const ARROW = 3;
/** Displacement of the warmest colour (px). */
const WARM = 12;
/** Confidence below which a marker counts as lost. */
const LOST = 0.3;

export function drawMarkers(context: CanvasRenderingContext2D, markers: Float32Array): void {
  context.lineWidth = 1.5;
  for (let k = 0; k + NUMBERS <= markers.length; k += NUMBERS) {
    const [x, y, dx, dy, confidence] = markers.subarray(k, k + NUMBERS) as unknown as [
      number,
      number,
      number,
      number,
      number,
    ];
    const share = Math.min(1, Math.hypot(dx, dy) / WARM);
    const colour = confidence < LOST ? "#888888" : `hsl(${210 * (1 - share)} 90% 55%)`;
    context.strokeStyle = context.fillStyle = colour;
    context.beginPath();
    context.arc(x, y, 3, 0, 2 * Math.PI);
    if (confidence < LOST) context.stroke();
    else context.fill();
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x + ARROW * dx, y + ARROW * dy);
    context.stroke();
  }
}
