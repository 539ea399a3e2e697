/** The socket of a live page, opened again whenever it is lost. */
import type { LiveOrder } from "../page_data";

/** Waits before another attempt, ms. */
const WAITS = [250, 500, 1000, 2000];

export interface Listener {
  row(message: ArrayBuffer): void;
  state(text: string): void;
  /** The connection is there, or lost. */
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

  /** Whether the order could be sent. */
  send(order: LiveOrder): boolean {
    if (this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(order));
    return true;
  }

  /** There is nothing more to come. */
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
