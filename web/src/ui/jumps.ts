/** Makes elements with `data-row` or `data-time` clickable: a click, or an added button, jumps to their time. */
import { moment } from "../format";
import type { Playback } from "../playback";
import { button } from "./dom";

export function startJumps(playback: Playback, shown: () => void): void {
  for (const element of document.querySelectorAll<HTMLElement>("[data-row], [data-time]")) {
    const row = rowOf(element, playback);
    if (row === undefined) continue;
    const jump = () => {
      playback.stopAt(row);
      shown();
    };
    const time = moment(playback.table.time(row));
    const name = `Show ${time}: ${(element.textContent ?? "").trim().slice(0, 80)}`;
    const opener = button(`▶\ufe0e ${time}`, name, jump);
    opener.className = "jump";
    const place = element.matches("tr, tbody") ? element.querySelector("td, th") : element;
    (place ?? element).append(" ", opener);
    element.classList.add("jumps");
    element.addEventListener("click", (event) => {
      const inside = event.target instanceof Element && event.target.closest("button, a, input");
      if (!inside) jump();
    });
  }
}

/** Row of an element; undefined if it is not a row of the run. */
function rowOf({ dataset }: HTMLElement, { table }: Playback): number | undefined {
  const number = Number(dataset.row ?? dataset.time);
  if (!Number.isFinite(number)) return undefined;
  const row = dataset.row === undefined ? table.rowAt(number) : number;
  return row >= 0 && row < table.length ? row : undefined;
}
