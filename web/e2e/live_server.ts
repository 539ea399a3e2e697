/** Rig for tests: serves a live page and sends a run to its socket. */
import { createServer } from "node:http";
import { WebSocketServer, type WebSocket } from "ws";
import { livePage } from "../sample/document";
import { columns, rowMessage } from "../sample/encode";
import { elements } from "../sample/hand";
import { liveData } from "../sample/page_data";
import { type Row, simulate } from "../sample/simulate";
import type { LiveState } from "../src/page_data";

const PATH = "/live/token";

export interface Rig {
  url: string;
  rows: Row[];
  orders: string[];
  send(row: Row): void;
  state(state: LiveState): void;
  /** Closes all sockets; pages reconnect. */
  cut(): void;
  sockets(): number;
  close(): Promise<void>;
}

export async function startRig(): Promise<Rig> {
  const run = simulate(2);
  const written = columns(2, elements().length);
  const text = livePage(liveData(run, { socket: PATH, keep: 200, orders: true, felt: true }));
  const server = createServer((request, response) => {
    response.setHeader("content-type", "text/html");
    response.end(request.url === "/" ? text : "");
  });
  const sockets = new Set<WebSocket>();
  const orders: string[] = [];
  new WebSocketServer({ server, path: PATH }).on("connection", (socket) => {
    sockets.add(socket);
    socket.on("message", (message) => orders.push(String(message)));
    socket.on("close", () => sockets.delete(socket));
  });
  await new Promise<void>((resolve) => server.listen(0, "127.0.0.1", resolve));
  const address = server.address();
  const port = typeof address === "object" ? address?.port : 0;
  const all = (data: string | ArrayBuffer) => sockets.forEach((socket) => socket.send(data));
  return {
    url: `http://127.0.0.1:${port}/`,
    rows: run.rows,
    orders,
    send: (row) => all(rowMessage(row, written)),
    state: (state) => all(JSON.stringify(state)),
    cut: () => sockets.forEach((socket) => socket.terminate()),
    sockets: () => sockets.size,
    close: async () => {
      sockets.forEach((socket) => socket.terminate());
      await new Promise((resolve) => server.close(resolve));
    },
  };
}
