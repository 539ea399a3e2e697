/** Draws the camera view of a fingertip with the tangential forces. */
import type { Contact, FingerColumns } from "../run";
import { SLIP } from "../run";
import { OVER_COLOUR, SLIP_COLOUR, TOUCH_COLOUR } from "../ui/colours";
import { type Camera, camera, growth, type Spot, spots } from "./optics";

/** Background of the camera image; dark in both themes. */
const GROUND = ["#23272c", "#0c0e10"] as const;
const ARROW = "#7fd4ff";
/** Outline and centre of the contact. */
const CONTACT = "#ff5fc0";
/** Corners of the contact's outline. */
const CORNERS = 48;
/** Half length of the cross at the centre of the contact; the image is 2 units wide. */
const CROSS = 0.09;
/** Radius of an unloaded spot; the image is 2 units wide. */
const SPOT = 0.035;
/** Length of an arrow per newton; the image is 2 units wide. */
export const ARROW_SCALE = 2.4;
/** Forces up to this value are noise (N). */
const LEAST_FORCE = 0.01;

export class Picture {
  readonly #columns: FingerColumns;
  readonly #camera: Camera;
  readonly #spots: Spot[];
  readonly #canvas: HTMLCanvasElement;

  constructor(canvas: HTMLCanvasElement, columns: FingerColumns) {
    this.#canvas = canvas;
    this.#columns = columns;
    this.#camera = camera(columns.finger.elements);
    this.#spots = spots(columns.finger.elements, this.#camera);
  }

  draw(row: number): void {
    const ctx = this.#canvas.getContext("2d");
    if (!ctx) return;
    const half = this.#canvas.width / 2;
    // Image coordinates: the edge is at 1, y points up.
    ctx.setTransform(half, 0, 0, -half, half, half);
    ctx.clearRect(-1, -1, 2, 2);
    this.#drawDome(ctx);
    const slips = (this.#columns.flags(row) & SLIP) !== 0;
    this.#spots.forEach((spot, i) => this.#drawSpot(ctx, spot, i, row, slips));
    this.#spots.forEach((spot, i) => this.#drawArrow(ctx, spot, i, row));
    const contact = this.#columns.contact(row);
    if (contact) this.#drawContact(ctx, contact);
  }

  /** Draws the centre of pressure as a cross, and the contact area as an ellipse if it is known. */
  #drawContact(ctx: CanvasRenderingContext2D, { centre, axes: [long, short] }: Contact): void {
    ctx.strokeStyle = CONTACT;
    ctx.lineWidth = 0.025;
    const [x, y] = this.#camera(centre);
    ctx.beginPath();
    ctx.moveTo(x - CROSS, y);
    ctx.lineTo(x + CROSS, y);
    ctx.moveTo(x, y - CROSS);
    ctx.lineTo(x, y + CROSS);
    ctx.stroke();
    if (!Number.isFinite(long[0])) return;
    ctx.beginPath();
    for (let corner = 0; corner < CORNERS; corner++) {
      const angle = (2 * Math.PI * corner) / CORNERS;
      const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
      const at = (k: 0 | 1 | 2) => centre[k] + cos * long[k] + sin * short[k];
      ctx.lineTo(...this.#camera([at(0), at(1), at(2)]));
    }
    ctx.closePath();
    ctx.stroke();
  }

  #drawDome(ctx: CanvasRenderingContext2D): void {
    const vignette = ctx.createRadialGradient(0, 0, 0.2, 0, 0, 1);
    vignette.addColorStop(0, GROUND[0]);
    vignette.addColorStop(1, GROUND[1]);
    ctx.fillStyle = vignette;
    ctx.beginPath();
    ctx.arc(0, 0, 1, 0, 2 * Math.PI);
    ctx.fill();
  }

  #drawSpot(ctx: CanvasRenderingContext2D, spot: Spot, i: number, row: number, slips: boolean): void {
    const { touchForce, overForce } = this.#columns.finger;
    const compression = this.#columns.compression(row, i);
    const [x, y] = this.#place(spot, i, row);
    const radius = SPOT * growth(compression);
    const light = Math.max(0.55, 1 - 0.3 * (x * x + y * y));
    ctx.fillStyle = `rgb(${Math.round(235 * light)} ${Math.round(238 * light)} ${Math.round(225 * light)})`;
    ctx.beginPath();
    ctx.arc(x, y, radius, 0, 2 * Math.PI);
    ctx.fill();
    if (compression <= touchForce) return;
    const over = compression > overForce;
    ctx.strokeStyle = over ? OVER_COLOUR : slips ? SLIP_COLOUR : TOUCH_COLOUR;
    ctx.lineWidth = over ? 0.035 : 0.022;
    ctx.beginPath();
    ctx.arc(x, y, radius + 0.025, 0, 2 * Math.PI);
    ctx.stroke();
  }

  /** Draws the tangential force on the feeler by the object as an arrow that starts at the spot. */
  #drawArrow(ctx: CanvasRenderingContext2D, spot: Spot, i: number, row: number): void {
    const [fx, fy] = this.#tangential(i, row);
    const newtons = Math.hypot(fx, fy);
    if (newtons < LEAST_FORCE || this.#columns.compression(row, i) < LEAST_FORCE) return;
    const [sx, sy] = spot.shear;
    const [dx, dy] = [fx * sx[0] + fy * sy[0], fx * sx[1] + fy * sy[1]];
    const seen = Math.hypot(dx, dy);
    if (seen < 1e-9) return;
    // The length depends on the force only, not on the position on the dome.
    const length = (ARROW_SCALE * newtons) / seen;
    const [x, y] = this.#place(spot, i, row);
    drawArrow(ctx, x, y, x + dx * length, y + dy * length);
  }

  #place(spot: Spot, i: number, row: number): [number, number] {
    const [fx, fy] = this.#tangential(i, row);
    const [sx, sy] = spot.shear;
    return [spot.x + fx * sx[0] + fy * sy[0], spot.y + fx * sx[1] + fy * sy[1]];
  }

  #tangential(i: number, row: number): [number, number] {
    const { forces } = this.#columns;
    return [forces?.at(row, 3 * i) || 0, forces?.at(row, 3 * i + 1) || 0];
  }
}

function drawArrow(ctx: CanvasRenderingContext2D, x: number, y: number, toX: number, toY: number): void {
  const angle = Math.atan2(toY - y, toX - x);
  const head = Math.min(0.07, 0.6 * Math.hypot(toX - x, toY - y));
  ctx.strokeStyle = ctx.fillStyle = ARROW;
  ctx.lineWidth = 0.02;
  ctx.beginPath();
  ctx.moveTo(x, y);
  ctx.lineTo(toX - 0.8 * head * Math.cos(angle), toY - 0.8 * head * Math.sin(angle));
  ctx.stroke();
  ctx.beginPath();
  ctx.moveTo(toX, toY);
  for (const side of [-0.4, 0.4]) {
    ctx.lineTo(toX - head * Math.cos(angle + side), toY - head * Math.sin(angle + side));
  }
  ctx.fill();
}
