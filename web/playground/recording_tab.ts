/** The tab that reports a recording of the reader. */
import { PageProblem } from "../src/problem";
import { make, setText } from "../src/ui/dom";
import type { Engine } from "./engine";
import { dropZone } from "./files";
import { reportFrame } from "./result";

/** Largest recording that is read (bytes). */
const LARGEST = 500e6;

export function recordingTab(engine: Engine): HTMLElement {
  const status = make("p", { class: "note", role: "status", "aria-live": "polite" });
  const bar = make("progress", { max: "1", hidden: "" });
  const result = make("div", {});
  async function show(file: File): Promise<void> {
    result.replaceChildren();
    if (file.size > LARGEST) {
      setText(
        status,
        `${file.name} has ${(file.size / 1e6).toFixed(0)} MB; this page reads up to ${LARGEST / 1e6} MB. Use: feeler report FOLDER`,
      );
      return;
    }
    setText(status, `Reading ${file.name}.`);
    bar.hidden = false;
    try {
      const report = await engine.call("report", { file }, (share) => (bar.value = share));
      setText(status, `Report of ${file.name}. The file has not left this computer.`);
      result.replaceChildren(reportFrame((use) => use(report), true));
    } catch (error) {
      setText(status, error instanceof PageProblem ? error.message : String(error));
    } finally {
      bar.hidden = true;
    }
  }
  const text = "Drop a recording.mcap here, or choose one: ";
  const zone = dropZone("recording", ".mcap", text, (file) => void show(file));
  return make(
    "div",
    {},
    make("p", {}, "The report of a recording, in this page. Nothing is uploaded."),
    zone,
    bar,
    status,
    result,
  );
}
