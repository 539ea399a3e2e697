/** Keyboard shortcuts, and the help that lists them. */
import { SPEEDS, type Playback } from "../playback";
import type { Run } from "../run";
import { button, make } from "./dom";

export interface Key {
  keys: string[];
  /** Notation in the help. */
  shown: string;
  does: string;
  act: (event: KeyboardEvent) => void;
}

/** Step size with shift (rows). */
const LARGE_STEP = 50;

export function playbackKeys(playback: Playback, run: Run): Key[] {
  const step = (sign: number) => (event: KeyboardEvent) =>
    playback.stopAt(playback.row + sign * (event.shiftKey ? LARGE_STEP : 1));
  const speed = (sign: number) => () => {
    const next = SPEEDS[SPEEDS.indexOf(playback.speed) + sign];
    if (next !== undefined) playback.setSpeed(next);
  };
  const keys: Key[] = [
    {
      keys: [" "],
      shown: "space",
      does: playback.live ? "pause, follow the latest data" : "play, pause",
      act: () => playback.toggle(),
    },
    { keys: ["ArrowLeft"], shown: "←", does: "one row back (50 with shift)", act: step(-1) },
    { keys: ["ArrowRight"], shown: "→", does: "one row forward (50 with shift)", act: step(1) },
    { keys: ["Home"], shown: "home", does: "go to the start", act: () => playback.stopAt(0) },
    { keys: ["End"], shown: "end", does: "go to the end", act: () => playback.stopAt(Infinity) },
  ];
  if (playback.live) return keys;
  const stroke = (sign: number) => () => playback.stopAt(nextStroke(run, playback.row, sign));
  return keys.concat([
    { keys: ["["], shown: "[", does: "previous stroke", act: stroke(-1) },
    { keys: ["]"], shown: "]", does: "next stroke", act: stroke(1) },
    { keys: ["+", "="], shown: "+", does: "faster", act: speed(1) },
    { keys: ["-"], shown: "−", does: "slower", act: speed(-1) },
  ]);
}

/** Start row of the next stroke in this direction. */
function nextStroke({ strokes }: Run, row: number, sign: number): number {
  const starts = strokes.map((stroke) => stroke.start);
  const next = sign > 0 ? starts.find((start) => start > row) : starts.findLast((start) => start < row);
  return next ?? (sign > 0 ? row : 0);
}

/** Installs the keyboard shortcuts and returns the button that opens the help. */
export function startKeyboard(keys: Key[], notes: string[]): HTMLElement {
  const dialog = helpDialog(keys, notes);
  const open = () => dialog.showModal();
  const help: Key = { keys: ["?"], shown: "?", does: "this help", act: open };
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || dialog.open || meantElsewhere(event)) return;
    const key = [...keys, help].find((key) => key.keys.includes(event.key));
    if (!key) return;
    event.preventDefault();
    key.act(event);
  });
  const opener = button("?", "Keyboard shortcuts and help (?)", open);
  return make("span", {}, opener, dialog);
}

/** `true` if the focused element handles the key itself. */
function meantElsewhere({ key, target }: KeyboardEvent): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (target instanceof HTMLInputElement && target.type === "range") return key.startsWith("Arrow");
  if (target.matches("input, select, textarea, [contenteditable]")) return true;
  return key === " " && target.matches("button, summary, a");
}

function helpDialog(keys: Key[], notes: string[]): HTMLDialogElement {
  const dialog = make("dialog", { class: "help", "aria-label": "Keyboard shortcuts and help" });
  const rows = keys.map(({ shown, does }) =>
    make("tr", {}, make("th", { scope: "row" }, make("kbd", {}, shown)), make("td", {}, does)),
  );
  if (rows.length) dialog.append(make("h2", {}, "Keyboard"), make("table", {}, make("tbody", {}, ...rows)));
  dialog.append(
    make("h2", {}, "Mouse and touch"),
    make("ul", {}, ...notes.map((note) => make("li", {}, note))),
  );
  const close = button("Close", "Close (Esc)", () => dialog.close());
  dialog.append(close);
  return dialog;
}
