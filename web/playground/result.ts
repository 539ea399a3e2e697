/** Result of a finished run: measures, claims, digest, report and downloads. */
import { button, make, setText } from "../src/ui/dom";
import type { Engine } from "./engine";
import { save } from "./files";
import type { FinishedRun, RunSettings } from "./protocol";
import { toCommand } from "./settings_link";

/** The part of `summary.json` that the page shows. */
export interface Summary {
  state: string;
  reason: string | null;
  sim_time: number;
  wall_time: number;
  strokes: Stroke[];
  claims: Claim[];
  hand_claims: Claim[];
  cap_angle: number | null;
  final_torque: number | null;
  peak_element_force: number | null;
  findings: Record<string, number>;
}

export interface Stroke {
  peak_torque: number | null;
  cap_turn: number | null;
  slip_fraction: number;
  true_slip_fraction: number | null;
  path_inward_bend: number | null;
  over_fraction: number;
}

interface Claim {
  id: string;
  text: string;
  verdict: string;
  holds: boolean | null;
}

export function shownClaims({ claims, hand_claims }: Summary): Claim[] {
  return claims.length > 0 ? claims : hand_claims;
}

/** Shows a finished run. Its report is created on first use. `note` names changes that its command does not reproduce, if any. */
export function resultPanel(
  engine: Engine,
  title: string,
  settings: Required<RunSettings>,
  finished: FinishedRun,
  note: string,
): HTMLElement {
  const summary = JSON.parse(finished.summary) as Summary;
  const claims = shownClaims(summary);
  const held = claims.filter(({ holds }) => holds).length;
  const factor = summary.sim_time / Math.max(summary.wall_time, 1e-9);
  const said = make("p", { class: "note", role: "status", "aria-live": "polite" });
  const told = (text: string) => setText(said, text);
  const reason = summary.reason ? `: ${summary.reason}` : "";
  let created: Promise<string> | undefined;
  const withReport: WithReport = (use) => {
    told("Creating the report.");
    created ??= engine.call("report", { file: new File([finished.recording], "recording.mcap") });
    created
      .then((html) => {
        told("");
        use(html);
      })
      .catch((error: Error) => told(error.message));
  };
  const name = `${settings.experiment}-${settings.sensing}-seed${settings.seed}`;
  return make(
    "section",
    { class: "result", "aria-label": `Result of ${title}` },
    make("h3", {}, `Result: ${title}`),
    make(
      "p",
      {},
      `The run is ${summary.state}${reason}. ${summary.sim_time.toFixed(2)} s were simulated in ` +
        `${summary.wall_time.toFixed(2)} s of computation, ${factor.toFixed(0)} times real time.`,
    ),
    claims.length > 0
      ? make("p", {}, `${held} of ${claims.length} claims hold:`)
      : make("p", {}, "The report checks no claims for this task."),
    make("ul", { class: "claims" }, ...claims.map(claimItem)),
    make("p", {}, "Digest of the run (SHA-256): ", make("code", { class: "digest" }, finished.digest)),
    ...(note ? [make("p", { class: "note" }, note)] : []),
    make(
      "div",
      { class: "orders" },
      download("recording.mcap", () => save(`${name}.mcap`, finished.recording, "application/octet-stream")),
      download("report.html", () => withReport((html) => save(`${name}.html`, html, "text/html"))),
      copy("Copy the command", () => toCommand(settings), told),
      copy("Copy the link", () => location.href, told),
    ),
    said,
    reportFrame(withReport),
  );
}

function claimItem({ text, holds, verdict }: Claim): HTMLElement {
  return make("li", {}, make("b", { class: holds ? "holds" : "fails" }, verdict), ` ${text}`);
}

/** Requests the HTML of a report, and calls `use` once it is available. */
type WithReport = (use: (html: string) => void) => void;

/** Collapsible frame with the complete report, which is requested when the frame is first open. */
export function reportFrame(get: WithReport, open = false): HTMLElement {
  const frame = make("iframe", { title: "Report of the run", class: "report" });
  const details = make("details", {}, make("summary", {}, "Complete report with all figures"), frame);
  const fill = () => {
    if (details.open && !frame.srcdoc) get((html) => (frame.srcdoc = html));
  };
  details.addEventListener("toggle", fill);
  details.open = open;
  fill();
  return details;
}

function download(text: string, act: () => void): HTMLElement {
  return button(`Download ${text}`, `Download ${text}`, act);
}

/** A button that copies a text, or shows it where the browser refuses. */
function copy(text: string, value: () => string, told: (text: string) => void): HTMLElement {
  return button(text, text, () => {
    navigator.clipboard
      ?.writeText(value())
      .then(() => told(`Copied: ${value()}`))
      .catch(() => told(value())) ?? told(value());
  });
}
