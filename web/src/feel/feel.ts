/** Plays grip and slip of the latest row as rumble and tone, and reports what was played. */
import type { LiveFelt } from "../page_data";
import { type FingerColumns, SLIP, TOUCH } from "../run";
import { feel, type Feeling, HOLD, NOTHING, SILENT, strongest, type Touch } from "./mapping";
import { FeelPanel } from "./panel";
import { Rumble } from "./rumble";
import { recall, remember, type Settings } from "./settings";
import { Tone } from "./tone";

/** Interval at which the age of data is checked (ms). */
const WATCH = 15;

export class Feel {
  readonly panel: FeelPanel;
  readonly #fingers: FingerColumns[];
  readonly #report: (felt: LiveFelt["felt"]) => void;
  readonly #rumble = new Rumble();
  #tone: Tone | undefined;
  #settings: Settings;
  #touches: Touch[] = [];
  /** Time of the latest row (s), and of its arrival (ms). */
  #time = NaN;
  #arrived = -Infinity;
  #playing = false;
  #over = false;

  constructor(fingers: FingerColumns[], report: (felt: LiveFelt["felt"]) => void) {
    this.#fingers = fingers;
    this.#report = report;
    this.#settings = recall(fingers.length);
    const names = fingers.map(({ finger }) => finger.name);
    this.panel = new FeelPanel(names, this.#settings, (settings) => this.#change(settings));
    // Browsers permit sound only after a click or key.
    for (const gesture of ["click", "keydown"]) addEventListener(gesture, () => this.#startTone());
    for (const change of ["gamepadconnected", "gamepaddisconnected"])
      addEventListener(change, () => this.#showState());
    document.addEventListener("visibilitychange", () => (document.hidden ? this.#stop() : this.#startTone()));
    addEventListener("pagehide", () => this.#stop());
    setInterval(() => this.#watch(), WATCH);
    this.#showState();
  }

  /** Plays a row that has just arrived. */
  row(row: number, time: number): void {
    this.#time = time;
    this.#arrived = performance.now();
    this.#touches = this.#fingers.map((finger) => touch(finger, row));
    if (!this.#isActive) return;
    const feeling = this.#feeling(0);
    const isHeard = this.#tone?.play(feeling) ?? false;
    this.#playing = true;
    this.#reportPlayed(feeling, this.#rumble.play(feeling, 0), isHeard);
    this.#showState();
  }

  /** Ends rumble and tone with the run. */
  end(): void {
    this.#over = true;
    this.#stop();
    this.#showState();
  }

  get #isActive(): boolean {
    return this.#settings.on && !this.#over && !document.hidden;
  }

  #change(settings: Settings): void {
    this.#settings = settings;
    remember(settings);
    if (settings.on) this.#startTone();
    else this.#stop();
    this.#showState();
  }

  #startTone(): void {
    if (!this.#isActive || this.#tone?.isRunning) return;
    // Chromium warns of sound that is started before the first click or key.
    if (navigator.userActivation?.hasBeenActive === false) return;
    this.#tone ??= new Tone(() => this.#showState());
    this.#tone.start();
  }

  /** Feeling of the chosen finger's touch, which was measured `age` ms ago. */
  #feeling(age: number): Feeling {
    const { finger, fullForce } = this.#settings;
    const touches = finger === undefined ? this.#touches : this.#touches.slice(finger, finger + 1);
    return strongest(touches.map((touch) => feel(touch, fullForce, age)));
  }

  /** Fades the rumble of stale data; the tone fades by itself. */
  #watch(): void {
    const age = performance.now() - this.#arrived;
    if (!this.#playing || age <= HOLD) return;
    const feeling = this.#feeling(age);
    this.#playing = age < SILENT;
    this.#reportPlayed(feeling, this.#rumble.play(feeling, age), this.#tone?.isRunning ?? false);
    this.#showState();
  }

  #stop(): void {
    this.#rumble.silence();
    this.#tone?.pause();
    if (!this.#playing) return;
    this.#playing = false;
    this.#reportPlayed(NOTHING, false, false);
  }

  #reportPlayed(feeling: Feeling, rumbles: boolean, isHeard: boolean): void {
    const { strong, weak } = rumbles ? feeling : NOTHING;
    const { frequency, gain } = isHeard ? feeling : NOTHING;
    this.#report({ time: this.#time, strong, weak, frequency, gain });
  }

  #showState(): void {
    const tone = this.#tone?.isRunning ? "Tone on." : "The tone starts after a click or key.";
    const on = this.#over ? "The run has ended." : `${tone} ${this.#rumble.state}`;
    this.panel.status(this.#settings.on ? on : "");
  }
}

/** Touch of a finger at a row. */
function touch(finger: FingerColumns, row: number): Touch {
  const flags = finger.flags(row);
  return {
    force: finger.graspForce?.at(row) ?? NaN,
    touch: (flags & TOUCH) !== 0,
    slip: (flags & SLIP) !== 0,
    shearRate: finger.shearRate?.at(row) ?? NaN,
  };
}
