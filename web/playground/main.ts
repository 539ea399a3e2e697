/** Entry point of the playground: feeler in one page, without a server. */
import uplotStyle from "uplot/dist/uPlot.min.css";
import { showProblem } from "../src/problem";
import { make } from "../src/ui/dom";
import { startTheme, themeButton } from "../src/ui/theme";
import { Engine } from "./engine";
import { FingertipTab } from "./fingertip_tab";
import { lessonsTab } from "./lessons";
import type { RunSettings } from "./protocol";
import { recordingTab } from "./recording_tab";
import type { Summary } from "./result";
import { compute, RunTab } from "./run_tab";
import { Tabs } from "./tabs";

declare global {
  interface Window {
    /** feeler for other pages and for tests. */
    feeler: {
      /** Computes a run; `digest` equals that of `feeler run` with the same settings. */
      run(settings: Partial<RunSettings>): Promise<{ summary: Summary; digest: string }>;
    };
  }
}

async function start(place: HTMLElement): Promise<void> {
  const status = make("p", { class: "note", role: "status" }, "Starting feeler.");
  place.append(status);
  const engine = await Engine.start();
  const catalogue = await engine.call("catalogue", undefined);
  window.feeler = {
    async run({ experiment = "cap-closing", set = [], ...settings }) {
      const { summary, digest } = await compute(engine, { experiment, set, ...settings });
      return { summary: JSON.parse(summary) as Summary, digest };
    },
  };
  const runs = new RunTab(engine, catalogue);
  const tabs = new Tabs();
  tabs.add("Run", runs.element);
  tabs.add(
    "Learn",
    lessonsTab(runs, () => tabs.open("Run")),
  );
  tabs.add("Your recording", recordingTab(engine));
  tabs.add("Your fingertip", new FingertipTab(engine).element);
  status.remove();
  place.append(tabs.element);
  tabs.open("Run");
}

document.head.append(make("style", {}, uplotStyle));
document.documentElement.classList.add("scripted");
startTheme();
document.body.prepend(make("div", { class: "page-tools" }, themeButton()));
const place = document.getElementById("playground") ?? document.body;
start(place).catch((error) => showProblem(place, error));
