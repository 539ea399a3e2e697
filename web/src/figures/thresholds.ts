/** Thresholds: dashed horizontal lines with their names. */
import type uPlot from "uplot";
import type { Panel } from "../page_data";
import { pageColour } from "../ui/colours";
import { scaled } from "./shading";
import { FONT } from "./style";

export function drawThresholds({ ctx, bbox, valToPos }: uPlot, { thresholds, y: axis }: Panel): void {
  ctx.save();
  ctx.strokeStyle = ctx.fillStyle = pageColour("soft");
  ctx.lineWidth = 1.2 * devicePixelRatio;
  ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
  ctx.font = scaled(FONT.replace("12px", "11px"));
  ctx.textAlign = "right";
  ctx.textBaseline = "bottom";
  const right = bbox.left + bbox.width;
  for (const { value, name } of thresholds) {
    const y = valToPos(value * axis.scale, "y", true);
    if (y < bbox.top || y > bbox.top + bbox.height) continue;
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(right, y);
    ctx.stroke();
    ctx.save();
    // Outline the text so that it is readable over curves.
    ctx.setLineDash([]);
    ctx.strokeStyle = pageColour("paper");
    ctx.lineWidth = 3 * devicePixelRatio;
    ctx.strokeText(name, right - 4 * devicePixelRatio, y - 2 * devicePixelRatio);
    ctx.restore();
    ctx.fillText(name, right - 4 * devicePixelRatio, y - 2 * devicePixelRatio);
  }
  ctx.restore();
}
