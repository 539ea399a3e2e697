/** WebSocket of a live page, which reconnects when the connection is lost. */
import type { LiveFelt, LiveOrder } from "../page_data";

/** Delays before successive attempts to reconnect (ms). The last one repeats. */
const WAITS = [250, 500, 1000, 2000];

export interface Listener {
  row(message: ArrayBuffer): void;
  state(text: string): void;
  /** Called when the connection is established (`true`) or lost (`false`). */
  connected(there: boolean): void;
}

export class Connection {
  readonly #url: string;
  readonly #listener: Listener;
  #socket: WebSocket | undefined;
  #attempt = 0;
  #ended = false;

  constructor(path: string, listener: Listener) {
    const url = new URL(path, location.href);
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    this.#url = url.href;
    this.#listener = listener;
    this.#open();
  }

  /** Sends a message; returns whether it was sent. */
  send(message: LiveOrder | LiveFelt): boolean {
    if (this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(message));
    return true;
  }

  /** Stops reconnecting. */
  end(): void {
    this.#ended = true;
  }

  #open(): void {
    const socket = new WebSocket(this.#url);
    socket.binaryType = "arraybuffer";
    this.#socket = socket;
    socket.addEventListener("open", () => {
      this.#attempt = 0;
      this.#listener.connected(true);
    });
    socket.addEventListener("message", ({ data }) => {
      if (data instanceof ArrayBuffer) this.#listener.row(data);
      else if (typeof data === "string") this.#listener.state(data);
    });
    socket.addEventListener("close", () => this.#lost());
  }

  #lost(): void {
    this.#listener.connected(false);
    if (this.#ended) return;
    const wait = WAITS[Math.min(this.#attempt++, WAITS.length - 1)];
    setTimeout(() => this.#open(), wait);
  }
}
