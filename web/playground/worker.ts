/** The worker: advances runs and reads recordings, so that the page never waits. */
import { catalogue, experiment, Fingertip, initSync, report, Run } from "../out/wasm/feeler_wasm";
import type { Calls, FinishedRun, LocatedFingertip, Reply, Request, RunState } from "./protocol";

/** Computation time between two messages to the page (ms): about one refresh of the screen. */
const BURST = 15;

interface Active {
  run: Run;
  /** Speed relative to real time; 0 while paused. */
  speed: number;
  /** Wall time (ms) and simulated time (s) at which the current speed was set. */
  since: { wall: number; simulated: number };
  /** Simulated time up to which the run advances as fast as possible (s). */
  skipUntil: number;
  state: RunState;
  /** Wall time spent so far (ms). */
  spent: number;
}

const scope = self as unknown as {
  postMessage(message: Reply, transfer?: Transferable[]): void;
  onmessage: ((event: MessageEvent) => void) | null;
};
const runs = new Map<number, Active>();
/** Yields to messages without the delay of timers. */
const yields = new MessageChannel();
let advancing = false;
let fingertip: Fingertip | undefined;

scope.onmessage = ({ data }) => {
  initSync({ module: data as WebAssembly.Module });
  scope.onmessage = ({ data }) => answer(data as Request);
  scope.postMessage({ kind: "ready" });
};

function answer({ call, name, argument }: Request): void {
  try {
    const result = (functions[name] as (argument: unknown, call: number) => unknown)(argument, call);
    scope.postMessage({ kind: "done", call, result });
  } catch (error) {
    scope.postMessage({
      kind: "failed",
      call,
      error: error instanceof Error ? error.message : String(error),
    });
  }
}

const functions: {
  [Name in keyof Calls]: (argument: Calls[Name]["argument"], call: number) => Calls[Name]["result"];
} = {
  catalogue: () => JSON.parse(catalogue()),
  experiment: ({ name }) => JSON.parse(experiment(name)),
  create({ run, settings, keep }) {
    const { experiment, seed, sensing, set } = settings;
    // In the order of the program, so that both write the same experiment and compute the same digest.
    const made = new Run(experiment, [
      ...set,
      ...(seed === undefined ? [] : [`seed=${seed}`]),
      ...(sensing ? [`sensing="${sensing}"`] : []),
    ]);
    const state = JSON.parse(made.state()) as RunState;
    runs.set(run, { run: made, speed: 0, since: { wall: 0, simulated: 0 }, skipUntil: 0, state, spent: 0 });
    return made.page(keep);
  },
  pace({ run, speed }) {
    const active = get(run);
    active.speed = speed;
    active.since = { wall: performance.now(), simulated: active.state.time };
    goOn();
  },
  skip({ run, time }) {
    get(run).skipUntil = time;
    goOn();
  },
  step({ run, steps }) {
    advance(run, get(run), () => steps);
  },
  order({ run, order }) {
    if (order === "stop") get(run).run.stop();
    else get(run).run.resume();
  },
  friction({ run, factor }) {
    get(run).run.set_friction(factor);
  },
  finish({ run }): FinishedRun {
    const active = get(run);
    runs.delete(run);
    const finished = active.run.finish(active.spent / 1000);
    const { digest, summary, recording } = finished;
    finished.free();
    return { digest, summary, recording };
  },
  discard({ run }) {
    runs.get(run)?.run.free();
    runs.delete(run);
  },
  locate: ({ rgba, width, height }) => setFingertip(new Fingertip(new Uint8Array(rgba), width, height)),
  layout: ({ text }) => setFingertip(Fingertip.from_layout(text)),
  calibrate: ({ text }) => requireFingertip().calibrate(text),
  thresholds({ touch, over, slip }) {
    fingertip?.set_thresholds(touch, over, slip);
  },
  track({ rgba, time }) {
    const fingertip = requireFingertip();
    const markers = fingertip.track(new Uint8Array(rgba), time);
    const sensed = fingertip.sensed();
    return { markers, sensed: sensed ? JSON.parse(sensed) : undefined };
  },
  report: ({ file }, call) =>
    report(file, (share: number) => scope.postMessage({ kind: "progress", call, share })),
};

/** Replaces the tracked fingertip and returns its description. */
function setFingertip(located: Fingertip): LocatedFingertip {
  fingertip?.free();
  fingertip = located;
  return {
    markers: located.markers(),
    width: located.width(),
    height: located.height(),
    layout: located.layout(),
    warnings: located.warnings(),
  };
}

function requireFingertip(): Fingertip {
  if (!fingertip)
    throw new Error("No markers have been located yet: open an image, a video or a layout first.");
  return fingertip;
}

function get(run: number): Active {
  const active = runs.get(run);
  if (!active) throw new Error("This run has ended.");
  return active;
}

function goOn(): void {
  if (advancing) return;
  advancing = true;
  yields.port2.postMessage(null);
}

yields.port1.onmessage = () => {
  advancing = false;
  let busy = false;
  let waiting = false;
  for (const [number, active] of runs) {
    if ((active.speed === 0 && !isSkipping(active)) || active.state.over) continue;
    const advanced = advance(number, active, stepsDue);
    busy ||= advanced;
    waiting ||= !advanced;
  }
  if (busy) goOn();
  else if (waiting) setTimeout(goOn, BURST / 2);
};

function isSkipping({ skipUntil, state }: Active): boolean {
  return state.time < skipUntil;
}

/** Number of steps to compute next, a few at a time: 0 if the run is ahead of its speed. */
function stepsDue(active: Active): number {
  const { speed, since, state } = active;
  if (speed === Infinity) return 4;
  if (isSkipping(active)) return Math.min(4, Math.ceil((active.skipUntil - state.time) / PERIOD));
  const due = since.simulated + (speed * (performance.now() - since.wall)) / 1000;
  return Math.min(4, Math.ceil((due - state.time) / PERIOD));
}

/** Smallest control period of the built-in experiments (s); only the pace depends on it. */
const PERIOD = 0.01;

/** Advances a run for one burst, and sends its rows. Returns `false` if no step was due. */
function advance(number: number, active: Active, due: (active: Active) => number): boolean {
  const start = performance.now();
  const rows: Uint8Array[] = [];
  try {
    do {
      const steps = due(active);
      if (steps <= 0) break;
      rows.push(active.run.step(steps));
      const skipped = isSkipping(active);
      active.state = JSON.parse(active.run.state());
      if (skipped) active.since = { wall: performance.now(), simulated: active.state.time };
    } while (
      (active.speed > 0 || isSkipping(active)) &&
      !active.state.over &&
      performance.now() - start < BURST
    );
  } catch (error) {
    active.speed = 0;
    scope.postMessage({ kind: "broken", run: number, error: String(error) });
    return false;
  }
  active.spent += performance.now() - start;
  if (rows.length === 0) return false;
  const buffer = concatenated(rows);
  scope.postMessage({ kind: "rows", run: number, rows: buffer, state: active.state }, [buffer]);
  return true;
}

function concatenated(parts: Uint8Array[]): ArrayBuffer {
  const bytes = new Uint8Array(parts.reduce((length, part) => length + part.length, 0));
  let place = 0;
  for (const part of parts) {
    bytes.set(part, place);
    place += part.length;
  }
  return bytes.buffer;
}
