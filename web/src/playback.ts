/** The current row, which scene, fingertips and figures show, and its playback. */
import type { Table } from "./table";

export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];

export class Playback {
  row = 0;
  playing = false;
  speed = 1;
  /** On a live page, `playing` means that the latest row is shown. */
  readonly live: boolean;
  /** Playback time (s), which may be between two rows. */
  #time = 0;
  #lastFrame: number | undefined;
  #frame = 0;
  readonly #momentListeners: ((row: number) => void)[] = [];
  readonly #stateListeners: (() => void)[] = [];

  constructor(
    readonly table: Table,
    { live = false } = {},
  ) {
    this.live = live;
    this.playing = live;
  }

  /** Calls `listener` with the current row after it may have changed, at most once per animation frame. */
  onMoment(listener: (row: number) => void): void {
    this.#momentListeners.push(listener);
  }

  /** Calls `listener` when playback starts or pauses and when the speed changes. */
  onState(listener: () => void): void {
    this.#stateListeners.push(listener);
  }

  seek(row: number): void {
    this.row = Math.min(Math.max(Math.round(row), 0), Math.max(this.table.length - 1, 0));
    this.#time = this.table.time(this.row);
    this.request();
  }

  seekTime(time: number): void {
    this.seek(this.table.rowAt(time));
  }

  /** Pauses at a row. */
  stopAt(row: number): void {
    this.pause();
    this.seek(row);
  }

  play(): void {
    if (this.playing) return;
    if (!this.live && this.row >= this.table.length - 1) this.seek(0);
    this.playing = true;
    this.#lastFrame = undefined;
    this.#stateChanged();
  }

  pause(): void {
    if (!this.playing) return;
    this.playing = false;
    this.#stateChanged();
  }

  toggle(): void {
    if (this.playing) this.pause();
    else this.play();
  }

  setSpeed(speed: number): void {
    this.speed = speed;
    this.#stateChanged();
  }

  /** Adjusts the row number after the oldest `rows` rows were dropped. */
  shift(rows: number): void {
    this.row = Math.max(0, this.row - rows);
  }

  /** Notifies the listeners in the next animation frame. */
  request(): void {
    this.#frame ||= requestAnimationFrame(this.#tick);
  }

  readonly #tick = (now: number): void => {
    this.#frame = 0;
    if (this.playing) this.#advance(now);
    for (const listener of this.#momentListeners) listener(this.row);
    if (this.playing && !this.live) this.request();
  };

  #advance(now: number): void {
    const last = this.table.length - 1;
    if (this.live) {
      this.row = Math.max(0, last);
      return;
    }
    // A page that was hidden resumes at the same time.
    const passed = Math.min(now - (this.#lastFrame ?? now), 250) / 1000;
    this.#lastFrame = now;
    this.#time += passed * this.speed;
    while (this.row < last && this.table.time(this.row + 1) <= this.#time) this.row++;
    if (this.row >= last) this.pause();
  }

  #stateChanged(): void {
    for (const listener of this.#stateListeners) listener();
    this.request();
  }
}
