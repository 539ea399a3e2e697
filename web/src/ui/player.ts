/** Playback bar at the bottom of the window. */
import { moment } from "../format";
import { SPEEDS, type Playback } from "../playback";
import type { Run } from "../run";
import { phaseColour } from "./colours";
import { button, make, setText } from "./dom";

/** Time without changes after which a screen reader announces the time (ms). */
const SETTLED = 700;

export class Player {
  readonly element: HTMLElement;
  readonly #playback: Playback;
  readonly #run: Run;
  readonly #play: HTMLButtonElement;
  readonly #slider: HTMLInputElement;
  readonly #time = make("output", { class: "player-time" });
  readonly #phase = make("span", { class: "player-phase" });
  readonly #spoken = make("p", { class: "sr", role: "status", "aria-live": "polite" });
  #settled = 0;

  constructor(playback: Playback, run: Run) {
    this.#playback = playback;
    this.#run = run;
    this.#play = button("", "", () => playback.toggle());
    this.#play.classList.add("play");
    this.#slider = make("input", { type: "range", min: "0", step: "1", value: "0", "aria-label": "Time" });
    this.#slider.addEventListener("input", () => playback.stopAt(Number(this.#slider.value)));
    const track = make("div", { class: "track" }, this.#slider);
    if (!playback.live) track.style.backgroundImage = strokeShades(run);
    this.element = make(
      "div",
      { class: "player", role: "group", "aria-label": "Playback" },
      this.#play,
      track,
    );
    this.element.append(make("div", { class: "player-now" }, this.#time, this.#phase), this.#spoken);
    if (!playback.live) this.element.append(this.#speeds());
    playback.onMoment((row) => this.#show(row));
    playback.onState(() => this.#showState());
    this.#showState();
  }

  #speeds(): HTMLElement {
    const select = make("select", { "aria-label": "Speed", title: "Speed (keys + and −)" });
    for (const speed of SPEEDS) select.append(make("option", { value: String(speed) }, `${speed}×`));
    select.addEventListener("change", () => this.#playback.setSpeed(Number(select.value)));
    const show = () => (select.value = String(this.#playback.speed));
    this.#playback.onState(show);
    show();
    return select;
  }

  #show(row: number): void {
    const { table } = this.#run;
    const last = String(Math.max(0, table.length - 1));
    if (this.#slider.max !== last) this.#slider.max = last;
    this.#slider.value = String(row);
    const time = table.length ? moment(table.time(row)) : "no data yet";
    const phase = this.#run.describe(row);
    setText(this.#time, time);
    setText(this.#phase, phase);
    this.#phase.style.borderColor = phaseColour(this.#run.phaseNumber(row));
    this.#slider.setAttribute("aria-valuetext", phase ? `${time}, ${phase}` : time);
    if (!this.#playback.playing) this.#speakLater(`${time}. ${phase}`);
  }

  #showState(): void {
    const { playing, live } = this.#playback;
    const name = playing ? "Pause" : live ? "Follow the latest data" : "Play";
    setText(this.#play, playing ? "❚❚" : "▶\ufe0e");
    this.#play.setAttribute("aria-label", name);
    this.#play.title = `${name} (space)`;
    this.#speakLater(playing ? "Playing." : "Paused.");
  }

  #speakLater(text: string): void {
    clearTimeout(this.#settled);
    this.#settled = window.setTimeout(() => setText(this.#spoken, text), SETTLED);
  }
}

/** Shades the MOVE phases in the background of the slider. */
function strokeShades({ strokes, table }: Run): string {
  const rows = Math.max(1, table.length - 1);
  const percent = (row: number) => `${((100 * row) / rows).toFixed(2)}%`;
  const stops = strokes.flatMap(({ move: [start, end] }) => [
    `transparent ${percent(start)}`,
    `var(--shade) ${percent(start)}`,
    `var(--shade) ${percent(end)}`,
    `transparent ${percent(end)}`,
  ]);
  return stops.length ? `linear-gradient(to right, transparent 0, ${stops.join(", ")})` : "none";
}
