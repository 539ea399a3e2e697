/** Minimal WebDriver BiDi client for Firefox. */
import { type ChildProcess, execSync, spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import WebSocket from "ws";

interface Reply {
  id?: number;
  method?: string;
  params?: { level?: string; text?: string };
  result?: Record<string, unknown>;
  message?: string;
}

/** A page in Firefox. */
export class Firefox {
  /** Console errors and uncaught exceptions. */
  readonly errors: string[] = [];
  readonly #socket: WebSocket;
  readonly #waiting = new Map<number, { done(result: never): void; failed(error: Error): void }>();
  #calls = 0;
  #context = "";

  private constructor(
    socket: WebSocket,
    readonly close: () => void,
  ) {
    this.#socket = socket;
    socket.on("message", (data) => this.#read(JSON.parse(String(data)) as Reply));
  }

  /** Starts Firefox and opens `url` in a window of `width` x `height` px. */
  static async open(url: string, width = 1280, height = 800): Promise<Firefox> {
    const program = process.env["FIREFOX"] ?? execSync("command -v firefox-esr").toString().trim();
    const profile = mkdtempSync(join(tmpdir(), "feeler-firefox-"));
    const flags = ["--headless", "--remote-debugging-port", "0", "--profile", profile];
    const child = spawn(program, flags, { stdio: ["ignore", "ignore", "pipe"] });
    const socket = new WebSocket(`${await address(child)}/session`);
    await new Promise((done, failed) => socket.once("open", done).once("error", failed));
    const firefox = new Firefox(socket, () => {
      child.kill();
      child.once("exit", () => rmSync(profile, { recursive: true, force: true }));
    });
    await firefox.#call("session.new", { capabilities: {} });
    await firefox.#call("session.subscribe", { events: ["log.entryAdded"] });
    const { contexts } = await firefox.#call<{ contexts: { context: string }[] }>(
      "browsingContext.getTree",
      {},
    );
    firefox.#context = contexts[0]?.context ?? "";
    const context = firefox.#context;
    await firefox.#call("browsingContext.setViewport", { context, viewport: { width, height } });
    await firefox.#call("browsingContext.navigate", { context, url, wait: "complete" });
    return firefox;
  }

  /** Evaluates an expression in the page, awaits promises, and returns the value. */
  async evaluate<T>(expression: string): Promise<T> {
    const { result, exceptionDetails } = await this.#call<{
      result?: { value: string };
      exceptionDetails?: { text: string };
    }>("script.evaluate", {
      expression: `Promise.resolve(${expression}).then((value) => JSON.stringify(value))`,
      target: { context: this.#context },
      awaitPromise: true,
    });
    if (!result) throw new Error(exceptionDetails?.text ?? "no result");
    return JSON.parse(result.value ?? "null") as T;
  }

  /** Sets the files of the input element that matches `selector`. */
  async setFiles(selector: string, files: string[]): Promise<void> {
    const context = this.#context;
    const { nodes } = await this.#call<{ nodes: { sharedId: string }[] }>("browsingContext.locateNodes", {
      context,
      locator: { type: "css", value: selector },
    });
    await this.#call("input.setFiles", { context, element: { sharedId: nodes[0]?.sharedId }, files });
  }

  #call<T>(method: string, params: object): Promise<T> {
    const id = this.#calls++;
    this.#socket.send(JSON.stringify({ id, method, params }));
    return new Promise<T>((done, failed) => this.#waiting.set(id, { done, failed }));
  }

  #read({ id, method, params, result, message }: Reply): void {
    if (method === "log.entryAdded" && params?.level === "error") this.errors.push(params.text ?? "");
    if (id === undefined) return;
    const waiting = this.#waiting.get(id);
    this.#waiting.delete(id);
    if (result) waiting?.done(result as never);
    else waiting?.failed(new Error(message));
  }
}

/** Returns the WebSocket address that Firefox prints on standard error. */
function address({ stderr }: ChildProcess): Promise<string> {
  return new Promise((done, failed) => {
    let text = "";
    // Firefox would block if its standard error were not read.
    stderr?.on("data", (data) => {
      text += String(data);
      const found = /WebDriver BiDi listening on (\S+)\n/.exec(text);
      if (found?.[1]) done(found[1]);
    });
    stderr?.once("end", () => failed(new Error(`Firefox ended: ${text}`)));
  });
}
