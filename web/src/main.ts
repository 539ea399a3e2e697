/** Entry point: adds the interactive parts to the document. Elements whose data are missing stay unchanged. */
import uplotStyle from "uplot/dist/uPlot.min.css";
import { FingertipPanel } from "./fingertip/panel";
import { figureViews, type Moments } from "./figures/figure";
import { inflate } from "./inflate";
import { LivePage } from "./live/live";
import { Ring } from "./live/ring";
import type { Live, PageData, RunTable } from "./page_data";
import { Playback } from "./playback";
import { PageProblem, showProblem } from "./problem";
import { readPage } from "./read_page";
import { FingerColumns, Run } from "./run";
import { scenePanel } from "./scene/panel";
import { readTable, type Table } from "./table";
import { make } from "./ui/dom";
import { startJumps } from "./ui/jumps";
import { type Key, playbackKeys, startKeyboard } from "./ui/keyboard";
import { Player } from "./ui/player";
import { startTheme, themeButton } from "./ui/theme";

/** Refresh interval of a live page's figures (ms). */
const REFRESH = 200;

const NOTES = [
  "Figures: moving the cursor sets the time of the whole page. Drag to zoom, double-click to reset. On a touch screen, one finger moves the cursor, two fingers zoom, and a double tap resets.",
  "Scene: drag to orbit, use the wheel or two fingers to zoom, and the right button or two fingers to pan. H or ⌂ returns to the home view.",
  "During playback, moving the mouse over figures does not change the time; a click does.",
  "▶ beside a claim shows its time. A click on a point with a command copies the command.",
];

async function start(): Promise<void> {
  document.head.append(make("style", {}, uplotStyle));
  document.documentElement.classList.add("scripted");
  startTheme();
  const keys: Key[] = [];
  try {
    const text = document.getElementById("page-data")?.textContent;
    if (!text) throw new PageProblem("This page contains no data.");
    const page = readPage(text);
    if (page.run) await startRun(page, page.run, keys);
    else figureViews(page.figures, undefined);
  } catch (error) {
    showProblem(document.body, error);
  }
  document.body.prepend(make("div", { class: "page-tools" }, themeButton(), startKeyboard(keys, NOTES)));
}

async function startRun(page: PageData, description: RunTable, keys: Key[]): Promise<void> {
  const ring = page.live && new Ring(description.columns, page.live.keep);
  const table = ring?.table ?? (await recorded(description));
  const run = new Run(table, description);
  const playback = new Playback(table, { live: page.live !== undefined });
  const fingers = (page.scene?.fingers ?? []).map((finger, i) => new FingerColumns(table, i, finger));
  const scene = startScene(page, run, playback, fingers);
  document.body.append(new Player(playback, run).element);
  keys.push(...playbackKeys(playback, run), ...scene.keys);
  startJumps(playback, () => document.getElementById("scene")?.scrollIntoView({ block: "nearest" }));
  const refresh = startFigures(page, { run, playback });
  if (page.live && ring) {
    startLive(page.live, ring, playback, fingers, scene.forget, keys);
    setInterval(refresh, REFRESH);
  }
  playback.request();
}

async function recorded(run: RunTable): Promise<Table> {
  const table = readTable(run, await inflate(run.data));
  if (table.length === 0) throw new PageProblem("The run has no rows: nothing was recorded.");
  return table;
}

/** Shows the scene and, beside it, the fingertips. */
function startScene({ scene }: PageData, run: Run, playback: Playback, fingers: FingerColumns[]) {
  const place = document.getElementById("scene");
  if (!scene || !place) return { keys: [], forget: () => {} };
  const { element, view, model } = scenePanel(scene, run, fingers);
  const tips = fingers.map((columns) => new FingertipPanel(columns));
  place.classList.add("scene");
  place.replaceChildren(element, make("div", { class: "fingertips" }, ...tips.map((tip) => tip.element)));
  playback.onMoment((row) => {
    view?.moveTo(row);
    for (const tip of tips) tip.show(row);
  });
  const home: Key = { keys: ["h", "H"], shown: "H", does: "home view", act: () => view?.goHome() };
  return { keys: view ? [home] : [], forget: () => model?.forgetTrails() };
}

/** Makes the figures interactive, and returns a function that updates them with new rows. */
function startFigures(page: PageData, moments: Moments): () => void {
  const figures = figureViews(page.figures, moments);
  moments.playback.onMoment((row) => {
    for (const figure of figures) figure.showRow(row);
  });
  return () => {
    if (!document.hidden) for (const figure of figures) figure.refresh();
  };
}

function startLive(
  live: Live,
  ring: Ring,
  playback: Playback,
  fingers: FingerColumns[],
  rowsGone: () => void,
  keys: Key[],
): void {
  const page = new LivePage(live, ring, playback, fingers, rowsGone);
  const place = document.getElementById("live") ?? document.getElementById("scene");
  if (place?.id === "live") place.replaceChildren(page.panel.element);
  else if (place) place.before(page.panel.element);
  else document.body.prepend(page.panel.element);
  keys.push({
    keys: ["f", "F"],
    shown: "F",
    does: "rumble and tone on or off",
    act: () => page.feel.panel.toggle(),
  });
  if (live.orders) {
    keys.push({ keys: ["s", "S"], shown: "S", does: "stop the hand", act: () => page.order("stop") });
  }
}

void start();
