/** Colours: the page's, from page.css, and those with a meaning (Okabe and Ito's, which colour-blind readers can tell). */

/** Names of the custom properties of page.css. */
type PageColour = "ink" | "soft" | "rule" | "paper" | "shade" | "grid";

/** As `pen.rs` of feeler-report has them: a finger has one colour everywhere. */
const FINGERS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9"];
/** The same hues, brighter, where the ground is dark. */
const FINGERS_ON_DARK = ["#4DA6E0", "#F28B45", "#2EC79A", "#E39BC4", "#8CCDF2"];

export const TOUCH_COLOUR = "#009E73";
export const SLIP_COLOUR = "#E69F00";
export const OVER_COLOUR = "#CC3F8F";

/** Tol's muted colours, which colour-blind readers can tell and which no finger has. */
const PHASES = ["#88CCEE", "#DDCC77", "#44AA99", "#CC6677", "#AA4499", "#999933", "#332288", "#DDDDDD"];

/** Colour of a phase by its number; none where it is not known. */
export function phaseColour(phase: number): string {
  return PHASES[phase % PHASES.length] ?? "transparent";
}

const read = new Map<string, string>();

/** A colour of page.css as it is now. */
export function pageColour(name: PageColour): string {
  let colour = read.get(name);
  if (colour === undefined) {
    // A custom property is handed out as it was written; a real property is computed.
    const probe = document.createElement("span");
    probe.style.color = `var(--${name})`;
    document.body.append(probe);
    colour = getComputedStyle(probe).color;
    probe.remove();
    read.set(name, colour);
  }
  return colour;
}

/** Forgets what was read of page.css, as the theme has changed. */
export function forgetPageColours(): void {
  read.clear();
}

export function fingerColour(finger: number, dark: boolean): string {
  const colours = dark ? FINGERS_ON_DARK : FINGERS;
  return colours[finger % colours.length] ?? "#000";
}
