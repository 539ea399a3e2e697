/** Tone of a feeling (Web Audio). Each update schedules its own fade, so that a page that hangs falls silent, too. */
import { type Feeling, freshness, HOLD, NOTHING, SILENT } from "./mapping";

/** Duration of changes, without which they would click (s). */
const SMOOTH = 0.01;

export class Tone {
  readonly #context: AudioContext;
  readonly #oscillator: OscillatorNode;
  readonly #gain: GainNode;
  /** Latest feeling, and its time on the audio clock (s). */
  #feeling: Readonly<Feeling> = NOTHING;
  #since = 0;

  /** Calls `changed` when the tone starts or stops running. */
  constructor(changed: () => void) {
    this.#context = new AudioContext({ latencyHint: "interactive" });
    this.#oscillator = new OscillatorNode(this.#context, { frequency: NOTHING.frequency });
    this.#gain = new GainNode(this.#context, { gain: 0 });
    this.#oscillator.connect(this.#gain).connect(this.#context.destination);
    this.#oscillator.start();
    this.#context.addEventListener("statechange", changed);
  }

  /** `true` if the tone can be heard. Browsers require a click or key first. */
  get isRunning(): boolean {
    return this.#context.state === "running";
  }

  /** Resumes after {@link pause}, as soon as the browser permits it. */
  start(): void {
    if (!this.isRunning) void this.#context.resume().catch(() => {});
  }

  /** Plays the feeling of new data until they are stale. Returns whether it can be heard. */
  play(feeling: Readonly<Feeling>): boolean {
    const { currentTime: now } = this.#context;
    const { gain } = this.#gain;
    const before = this.#feeling.gain * freshness(1000 * (now - this.#since));
    gain.cancelScheduledValues(now);
    gain.setValueAtTime(before, now);
    gain.linearRampToValueAtTime(feeling.gain, now + SMOOTH);
    gain.setValueAtTime(feeling.gain, now + HOLD / 1000);
    gain.linearRampToValueAtTime(0, now + SILENT / 1000);
    this.#oscillator.frequency.setTargetAtTime(feeling.frequency, now, SMOOTH / 3);
    this.#feeling = feeling;
    this.#since = now;
    return this.isRunning;
  }

  /** Falls silent at once. */
  silence(): void {
    const { currentTime: now } = this.#context;
    this.#gain.gain.cancelScheduledValues(now);
    this.#gain.gain.setTargetAtTime(0, now, SMOOTH / 3);
    this.#feeling = NOTHING;
  }

  /** Falls silent and releases the audio device. */
  pause(): void {
    this.silence();
    if (this.isRunning) void this.#context.suspend().catch(() => {});
  }
}
