/** Simple static versions of the sample's figures; feeler-report draws its own. */
import { readFileSync } from "node:fs";
import type { Figure } from "../src/page_data";

/** The folder `web/`, in which tests and scripts run. */
export const ROOT = process.cwd();

const real = () => readFileSync(`${ROOT}/../docs/figures/fig-13.svg`, "utf8");

export function still(figure: Figure): string {
  if (figure.number === 13) return real();
  const titles = figure.panels.map((panel) => panel.y.label).join(" and ");
  const curves = figure.panels.map((_, i) => {
    const top = 30 + 130 * i;
    const points = Array.from({ length: 90 }, (_, x) => {
      const y = Math.max(0, Math.sin(x / 4 + i)) ** 2;
      return `${60 + 4.5 * x},${(top + 110 - 90 * y).toFixed(1)}`;
    });
    return `<polyline points="${points.join(" ")}" fill="none" stroke="#0072B2" stroke-width="1.6"/>
      <rect x="60" y="${top}" width="405" height="110" fill="none" stroke="#555"/>`;
  });
  const height = 60 + 130 * figure.panels.length;
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 480 ${height}" role="img" aria-label="${titles}">
    <rect width="480" height="${height}" fill="white"/>${curves.join("")}
    <text x="60" y="20" font-size="14" font-family="DejaVu Sans, sans-serif">${titles}</text></svg>`;
}
