/** Colours of the page (from page.css) and colours with a meaning (Okabe and Ito, safe for colour-blind readers). */

/** Custom properties of page.css. */
type PageColour = "ink" | "soft" | "rule" | "paper" | "shade" | "grid";

/** Finger colours, as in `pen.rs` of feeler-report. */
const FINGERS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9"];
/** Brighter versions of the same hues for dark backgrounds. */
const FINGERS_ON_DARK = ["#4DA6E0", "#F28B45", "#2EC79A", "#E39BC4", "#8CCDF2"];

export const TOUCH_COLOUR = "#009E73";
export const SLIP_COLOUR = "#E69F00";
export const OVER_COLOUR = "#CC3F8F";

/** Tol's muted colours: safe for colour-blind readers and distinct from the fingers. */
const PHASES = ["#88CCEE", "#DDCC77", "#44AA99", "#CC6677", "#AA4499", "#999933", "#332288", "#DDDDDD"];

/** Colour of a phase; transparent if the phase is unknown. */
export function phaseColour(phase: number): string {
  return PHASES[phase % PHASES.length] ?? "transparent";
}

const read = new Map<string, string>();

/** Current value of a colour of page.css. */
export function pageColour(name: PageColour): string {
  let colour = read.get(name);
  if (colour === undefined) {
    // A custom property is returned as written; a real property is computed.
    const probe = document.createElement("span");
    probe.style.color = `var(--${name})`;
    document.body.append(probe);
    colour = getComputedStyle(probe).color;
    probe.remove();
    read.set(name, colour);
  }
  return colour;
}

/** Clears the cached colours after a change of theme. */
export function forgetPageColours(): void {
  read.clear();
}

export function fingerColour(finger: number, dark: boolean): string {
  const colours = dark ? FINGERS_ON_DARK : FINGERS;
  return colours[finger % colours.length] ?? "#000";
}
