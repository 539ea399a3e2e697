/** The program itself, for the tests: FEELER is its path. */
import assert from "node:assert/strict";
import { type ChildProcess, spawn } from "node:child_process";
import { mkdtempSync } from "node:fs";
import { request } from "node:http";
import { tmpdir } from "node:os";
import { join } from "node:path";

const FEELER = process.env["FEELER"];
const LACKS = "FEELER is not set: expected the path of the program `feeler`, built with --all-features";
const REQUIRED = !["", "0"].includes(process.env["FEELER_REQUIRE_ALL"] ?? "");

/** Why the tests of the program are skipped, if they are. */
export const skip: string | false = FEELER || REQUIRED ? false : LACKS;

/** A new folder, in which programs work. */
export const folder = (): string => mkdtempSync(join(tmpdir(), "feeler-e2e-"));

const running = new Set<ChildProcess>();

/** Ends what tests left. */
export function killAll(): void {
  for (const child of running) child.kill("SIGKILL");
}

/** A program that runs. */
export class Program {
  readonly #child: ChildProcess;
  /** Its exit status. */
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

  /** All that it has said. */
  get said(): string {
    return this.#said;
  }

  /** What it says, once that is there. */
  async says(what: RegExp): Promise<RegExpExecArray> {
    for (;;) {
      const found = what.exec(this.#said);
      if (found) return found;
      assert.ok(running.has(this.#child), `it ended without ${what}: ${this.#said}`);
      await new Promise<void>((resolve) => this.#listeners.push(resolve));
    }
  }

  /** The address of its page. */
  async url(): Promise<string> {
    return (await this.says(/^live page: (.*)$/m))[1] ?? "";
  }

  /** Ends it as Ctrl-C does. */
  interrupt(): Promise<number | null> {
    this.#child.kill("SIGINT");
    return this.ended;
  }
}

/** The answer to a request with headers that a browser would not let a page choose; 101 for a socket that opened. */
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
