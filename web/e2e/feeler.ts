/** Runs the program `feeler` in tests. FEELER is its path. */
import assert from "node:assert/strict";
import { type ChildProcess, spawn } from "node:child_process";
import { mkdtempSync } from "node:fs";
import { request } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";

const FEELER = process.env["FEELER"];
const LACKS = "FEELER is not set: expected the path of the program `feeler`, built with --all-features";
const REQUIRED = !["", "0"].includes(process.env["FEELER_REQUIRE_ALL"] ?? "");

/** Reason for skipping tests that need the program, or `false`. */
export const skip: string | false = FEELER || REQUIRED ? false : LACKS;

/** Creates a temporary working folder. */
export const folder = (): string => mkdtempSync(join(tmpdir(), "feeler-e2e-"));

const running = new Set<ChildProcess>();

/** Kills all running programs. */
export function killAll(): void {
  for (const child of running) child.kill("SIGKILL");
}

/** A running instance of `feeler`. */
export class Program {
  readonly #child: ChildProcess;
  /** Exit status. */
  readonly ended: Promise<number | null>;
  #said = "";
  #listeners: (() => void)[] = [];

  constructor(where: string, args: string[]) {
    assert.ok(FEELER, LACKS);
    const child = spawn(FEELER, args, { cwd: where, stdio: ["ignore", "pipe", "pipe"] });
    this.#child = child;
    running.add(child);
    const hear = (text: string) => {
      this.#said += text;
      for (const listener of this.#listeners) listener();
    };
    child.stdout.setEncoding("utf8").on("data", hear);
    child.stderr.setEncoding("utf8").on("data", hear);
    this.ended = new Promise((resolve, reject) => {
      child.on("error", reject);
      child.on("close", (status) => {
        running.delete(child);
        hear("");
        resolve(status);
      });
    });
  }

  /** Output so far. */
  get said(): string {
    return this.#said;
  }

  /** Waits until the output matches `what`. Fails if the program ends before. */
  async says(what: RegExp): Promise<RegExpExecArray> {
    for (;;) {
      const found = what.exec(this.#said);
      if (found) return found;
      assert.ok(running.has(this.#child), `the program ended without printing ${what}: ${this.#said}`);
      await new Promise<void>((resolve) => this.#listeners.push(resolve));
    }
  }

  /** URL of its live page. */
  async url(): Promise<string> {
    return (await this.says(/^live page: (.*)$/m))[1] ?? "";
  }

  /** Sends SIGINT, as Ctrl-C does, and waits for the exit status. */
  interrupt(): Promise<number | null> {
    this.#child.kill("SIGINT");
    return this.ended;
  }
}

/** Sends a request with headers that a page cannot set in a browser. The status is 101 if a WebSocket opened. */
export function ask(url: string, headers: Record<string, string>): Promise<{ status: number; body: string }> {
  return new Promise((resolve, reject) => {
    const asking = request(url, { headers, agent: false });
    asking.on("upgrade", (response, socket) => {
      socket.destroy();
      resolve({ status: response.statusCode ?? 0, body: "" });
    });
    asking.on("response", (response) => {
      let body = "";
      response.setEncoding("utf8").on("data", (text: string) => (body += text));
      response.on("end", () => resolve({ status: response.statusCode ?? 0, body }));
    });
    asking.on("error", reject);
    asking.end();
  });
}
