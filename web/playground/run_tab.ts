/** The tab in which runs are computed and shown. */
import { readPage } from "../src/read_page";
import { PageProblem } from "../src/problem";
import { button, make, setText } from "../src/ui/dom";
import { Player } from "../src/ui/player";
import type { Engine } from "./engine";
import { RunForm } from "./form";
import type { Calls, Catalogue, FinishedRun, RunSettings, RunState } from "./protocol";
import { resultPanel, type Summary } from "./result";
import { fromHash, lawOf, type PageSettings, toHash, withLaw } from "./settings_link";
import { RunView } from "./run_view";

/** Number of rows that a view keeps: two minutes at 100 Hz. */
const KEEP = 12_000;
/** Time without motion of a slider after which the run is computed again (ms). */
const RECOMPUTE_DELAY = 200;
const SPEEDS: [number, string][] = [
  [0.25, "quarter speed"],
  [1, "real time"],
  [4, "4 × real time"],
  [16, "16 × real time"],
  [Infinity, "as fast as possible"],
];

interface Shown {
  number: number;
  title: string;
  settings: Required<RunSettings>;
  view: RunView;
  over: boolean;
}

/** Called with every finished run. */
export type Finished = (settings: RunSettings, summary: Summary, digest: string) => void;

export class RunTab {
  readonly element: HTMLElement;
  readonly form: RunForm;
  readonly #engine: Engine;
  readonly #views = make("div", { class: "run-views" });
  readonly #results = make("div", { class: "results" });
  readonly #status = make("p", { class: "note", role: "status", "aria-live": "polite" });
  readonly #pause: HTMLButtonElement;
  readonly #step: HTMLButtonElement;
  readonly #end: HTMLButtonElement;
  readonly #speed = make("select", { id: "speed" });
  readonly #finished: Finished[] = [];
  #player: HTMLElement | undefined;
  #shown: Shown[] = [];
  #paused = false;
  /** Simulated time of the first change during the run (s). */
  #changedAt: number | undefined;
  #time = 0;
  /** Friction of the run at its start, relative to the experiment's. */
  #startFriction = 1;
  /** Timer that computes the run again after a slider has moved. */
  #recompute: ReturnType<typeof setTimeout> | undefined;
  /** Resolves when the latest run has been set up. */
  #setUp: Promise<void> = Promise.resolve();

  constructor(engine: Engine, catalogue: Catalogue) {
    this.#engine = engine;
    this.form = new RunForm(
      catalogue,
      (name) => engine.call("experiment", { name }),
      () => void this.start(),
      (slider) => this.#moved(slider),
    );
    this.#speed.append(...SPEEDS.map(([speed, text]) => make("option", { value: String(speed) }, text)));
    this.#speed.value = "1";
    this.#speed.addEventListener("change", () => this.#pace());
    this.#pause = button("Pause", "Pause or continue the computation", () => this.#toggle());
    this.#step = button("Step", "Compute one control step", () => this.#each("step", { steps: 1 }));
    this.#end = button("End", "End the run now and show its result", () => void this.#finish());
    const controls = make(
      "div",
      { class: "orders" },
      this.#pause,
      this.#step,
      this.#end,
      make("label", { for: "speed" }, "Speed"),
      this.#speed,
    );
    this.#enable(false);
    const left = make("div", { class: "run-controls" }, this.form.element, controls, this.#status);
    this.element = make("div", { class: "run-tab" }, left, make("div", {}, this.#views, this.#results));
    const apply = () => void this.form.apply(fromHash(location.hash));
    apply();
    addEventListener("hashchange", () => {
      if (location.hash !== toHash(this.form.settings())) apply();
    });
  }

  onFinished(finished: Finished): void {
    this.#finished.push(finished);
  }

  /** Shows `settings` and starts the run at `speed` times real time. */
  start(settings?: Partial<PageSettings>, speed?: number): Promise<void> {
    return this.#next(() => this.#start(settings, speed));
  }

  /** Calls `setUp` after earlier runs have been set up. */
  #next(setUp: () => Promise<void>): Promise<void> {
    const done = this.#setUp.then(setUp);
    this.#setUp = done.catch(() => {});
    return done;
  }

  /** Sets up a run, and computes it as fast as possible up to `time` (s). */
  async #start(settings?: Partial<PageSettings>, speed?: number, time = 0, paused = false): Promise<void> {
    if (settings && !(await this.form.apply(settings))) return;
    if (speed !== undefined) this.#speed.value = String(speed);
    const chosen = this.form.settings();
    history.replaceState(null, "", toHash(chosen));
    await this.#close();
    setText(this.#status, "Setting up the run.");
    try {
      const { compare, ...first } = chosen;
      const all = compare ? [first, { ...first, set: withLaw(first.set, compare) }] : [first];
      for (const [place, settings] of all.entries()) {
        const law = place === 1 ? compare : lawOf(settings.set) || this.form.ownLaw;
        await this.#create(`${settings.experiment}, ${law}, seed ${settings.seed}`, settings);
      }
      this.#paused = paused;
      this.#enable(true);
      if (time > 0) this.#each("skip", { time });
      this.#pace();
      setText(
        this.#status,
        "The run is being computed in this page. Friction changes it from now on; other sliders recompute it up to the present time.",
      );
    } catch (error) {
      await this.#close();
      setText(this.#status, problem(error));
    }
  }

  async #create(title: string, settings: Required<RunSettings>): Promise<void> {
    const shown: Partial<Shown> = { title, settings, over: false };
    const number = this.#engine.listen({
      rows: (rows, state) => this.#rows(shown as Shown, rows, state),
      broken: (error) => {
        shown.view?.fail(error);
        setText(this.#status, error);
        this.#enable(false);
      },
    });
    const page = readPage(await this.#engine.call("create", { run: number, settings, keep: KEEP }));
    const view = new RunView(page, title, KEEP, (order) => {
      void this.#engine.call("order", { run: number, order });
      this.#changedAt ??= this.#time;
    });
    Object.assign(shown, { number, view });
    this.#shown.push(shown as Shown);
    this.#views.append(view.element);
    if (this.#shown.length === 1) {
      this.#player = new Player(view.playback, view.run).element;
      document.body.append(this.#player);
    } else {
      this.#follow(view);
    }
  }

  /** Lets `view` show the time of the first view when the reader looks at earlier rows. */
  #follow(view: RunView): void {
    const first = this.#shown[0]?.view;
    if (!first || first === view) return;
    first.playback.onState(() => {
      if (first.playback.playing) view.playback.play();
      else view.playback.pause();
    });
    first.playback.onMoment((row) => {
      if (!first.playback.playing && first.run.table.length > 0) {
        view.playback.seekTime(first.run.table.time(row));
      }
    });
  }

  #rows(shown: Shown, rows: ArrayBuffer, state: RunState): void {
    this.#time = state.time;
    shown.view.add(rows, state);
    if (!state.over || shown.over) return;
    shown.over = true;
    if (this.#shown.every(({ over }) => over)) void this.#finish();
  }

  async #finish(): Promise<void> {
    this.#enable(false);
    setText(this.#status, "Evaluating the run.");
    for (const shown of this.#shown) {
      const { number, title, settings } = shown;
      // A run that is ended early has no further rows to wait for.
      shown.over = true;
      try {
        const finished = await this.#engine.call("finish", { run: number });
        this.#results.append(resultPanel(this.#engine, title, settings, finished, this.#note()));
        const summary = JSON.parse(finished.summary) as Summary;
        for (const listener of this.#finished) listener(settings, summary, finished.digest);
      } catch (error) {
        setText(this.#status, problem(error));
        return;
      }
    }
    setText(this.#status, "The run has ended; see its result below.");
  }

  #note(): string {
    if (this.#changedAt === undefined) return "";
    return `You changed the run at ${this.#changedAt.toFixed(2)} s. The command and the link do not repeat that, so they lead to another digest.`;
  }

  #moved(slider: string): void {
    if (this.#shown.length === 0 || this.#shown.every(({ over }) => over)) return;
    if (slider !== "friction") {
      clearTimeout(this.#recompute);
      this.#recompute = setTimeout(() => this.#computeAgain(), RECOMPUTE_DELAY);
      return;
    }
    const factor = this.form.sliders.factor("friction") / this.#startFriction;
    this.#each("friction", { factor });
    this.#changedAt ??= this.#time;
  }

  /** Computes the shown runs again with the values of the sliders, up to the present time. */
  #computeAgain(): void {
    const { experiment } = this.form.settings();
    if (this.#shown.some(({ settings, over }) => over || settings.experiment !== experiment)) return;
    void this.#next(() => this.#start(undefined, undefined, this.#time, this.#paused));
  }

  #toggle(): void {
    this.#paused = !this.#paused;
    this.#enable(true);
    this.#pace();
  }

  #pace(): void {
    this.#each("pace", { speed: this.#paused ? 0 : Number(this.#speed.value) });
  }

  #each<Name extends "pace" | "skip" | "step" | "friction">(
    name: Name,
    argument: Omit<Calls[Name]["argument"], "run">,
  ): void {
    for (const { number, over } of this.#shown) {
      if (over) continue;
      const call = this.#engine.call(name, { run: number, ...argument } as never);
      call.catch((error) => setText(this.#status, problem(error)));
    }
  }

  #enable(running: boolean): void {
    for (const control of [this.#pause, this.#end]) control.disabled = !running;
    this.#step.disabled = !running || !this.#paused;
    setText(this.#pause, this.#paused ? "Continue" : "Pause");
  }

  /** Discards all runs and their views. */
  async #close(): Promise<void> {
    for (const { number, view } of this.#shown) {
      view.close();
      this.#engine.forget(number);
      await this.#engine.call("discard", { run: number });
    }
    this.#shown = [];
    clearTimeout(this.#recompute);
    this.#changedAt = undefined;
    this.#startFriction = this.form.sliders.factor("friction");
    this.#player?.remove();
    this.#views.replaceChildren();
    this.#results.replaceChildren();
    this.#enable(false);
  }
}

function problem(error: unknown): string {
  return error instanceof PageProblem ? error.message : `The run failed: ${error}`;
}

/** Computes a run as fast as possible without showing it. */
export async function compute(engine: Engine, settings: RunSettings): Promise<FinishedRun> {
  let over: () => void = () => {};
  let failed: (error: Error) => void = () => {};
  const ended = new Promise<void>((resolve, reject) => ([over, failed] = [resolve, reject]));
  const run = engine.listen({
    rows: (_, state) => state.over && over(),
    broken: (error) => failed(new PageProblem(error)),
  });
  await engine.call("create", { run, settings, keep: 2 });
  await engine.call("pace", { run, speed: Infinity });
  await ended.finally(() => engine.forget(run));
  return engine.call("finish", { run });
}
