/** The page's side of its worker: feeler without a server. */
import { decompress } from "fzstd";
import { PageProblem } from "../src/problem";
import { unpack } from "./packed_text.mjs";
import type { Calls, Reply, RunState } from "./protocol";

/** Events of one run. */
export interface RunListener {
  rows(rows: ArrayBuffer, state: RunState): void;
  broken(error: string): void;
}

interface Waiting {
  done(result: never): void;
  failed(error: Error): void;
  progress: ((share: number) => void) | undefined;
}

export class Engine {
  readonly #worker: Worker;
  readonly #waiting = new Map<number, Waiting>();
  readonly #listeners = new Map<number, RunListener>();
  #calls = 0;
  #runs = 0;

  private constructor(worker: Worker) {
    this.#worker = worker;
    worker.onmessage = ({ data }) => this.#read(data as Reply);
    worker.onerror = (event) => this.#lost(event.message);
  }

  /** Starts the worker with the program and the script that the page contains. */
  static async start(): Promise<Engine> {
    const [program, script] = ["feeler-wasm", "feeler-worker"].map(
      (id) => document.getElementById(id)?.textContent,
    );
    if (!program || !script)
      throw new PageProblem("This page is incomplete: it does not contain feeler's program.");
    const module = await WebAssembly.compile(decompress(unpack(program)) as BufferSource);
    const url = URL.createObjectURL(new Blob([script], { type: "text/javascript" }));
    const worker = new Worker(url);
    await new Promise<void>((resolve, reject) => {
      worker.onmessage = () => resolve();
      worker.onerror = (event) => reject(new PageProblem(`feeler's program did not start: ${event.message}`));
      worker.postMessage(module);
    });
    return new Engine(worker);
  }

  call<Name extends keyof Calls>(
    name: Name,
    argument: Calls[Name]["argument"],
    progress?: (share: number) => void,
  ): Promise<Calls[Name]["result"]> {
    const call = this.#calls++;
    return new Promise((done, failed) => {
      this.#waiting.set(call, { done, failed, progress });
      this.#worker.postMessage({ call, name, argument });
    });
  }

  /** Returns the number of a new run whose events go to `listener`. */
  listen(listener: RunListener): number {
    this.#listeners.set(this.#runs, listener);
    return this.#runs++;
  }

  /** Removes the listener of a run, so that its view can be freed. */
  forget(run: number): void {
    this.#listeners.delete(run);
  }

  #read(reply: Reply): void {
    switch (reply.kind) {
      case "ready":
        return;
      case "rows":
        return this.#listeners.get(reply.run)?.rows(reply.rows, reply.state);
      case "broken":
        return this.#listeners.get(reply.run)?.broken(reply.error);
    }
    const waiting = this.#waiting.get(reply.call);
    if (reply.kind === "progress") return waiting?.progress?.(reply.share);
    this.#waiting.delete(reply.call);
    if (reply.kind === "done") waiting?.done(reply.result as never);
    else waiting?.failed(new PageProblem(reply.error));
  }

  /** The worker ended, for example because the browser has no memory left. */
  #lost(message: string): void {
    const error = new PageProblem(`feeler's program ended: ${message}. Reload the page.`);
    for (const { failed } of this.#waiting.values()) failed(error);
    for (const listener of this.#listeners.values()) listener.broken(error.message);
    this.#waiting.clear();
  }
}
