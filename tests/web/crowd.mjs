// Many pages at one overseer, one of which does not read: what it costs the nodes and the overseer.
import net from "node:net";
import { pause } from "./real_run.mjs";
import WebSocket from "ws";

const median = (numbers) => [...numbers].sort((a, b) => a - b)[Math.floor(numbers.length / 2)];

export class Crowd {
  /**
   * @param {import("./real_run.mjs").Program & {url: string}} overseer
   * @param {import("./real_run.mjs").Witness} witness
   */
  constructor(overseer, witness, for_s) {
    Object.assign(this, { overseer, witness, for_s, frames: 0, sockets: [] });
  }

  #join() {
    const socket = new WebSocket(`${this.overseer.url.replace("http", "ws")}ws`);
    socket.on("message", (_, isBinary) => { this.frames += isBinary ? 1 : 0; });
    socket.on("error", () => {});
    this.sockets.push(socket);
  }

  /** Asks for the WebSocket and then reads nothing. */
  #joinStalled() {
    const { hostname, port, host } = new URL(this.overseer.url);
    this.stalled = net.connect(Number(port), hostname);
    this.stalled.on("error", () => {});
    this.stalled.write(`GET /ws HTTP/1.1\r\nHost: ${host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n`
      + "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n");
    this.stalled.pause();
  }

  /** The slowest region's median frame time, asked for once a second. */
  async #frame_ms(for_s) {
    const told = [];
    for (let i = 0; i < for_s; ++i) {
      await pause(1000);
      told.push(Math.max(...(await this.witness.metrics()).frame_p50_ms));
    }
    return median(told);
  }

  async measure(count) {
    const before = await this.#frame_ms(Math.max(5, this.for_s / 2));
    const rss_before = this.overseer.rss_MB();
    for (let i = 1; i < count; ++i) this.#join();
    this.#joinStalled();
    await pause(4000);
    const [settled, frames, cpu_s, start] = [this.overseer.rss_MB(), this.frames, this.overseer.cpu_s(), Date.now()];
    const during = await this.#frame_ms(this.for_s);
    const took_s = (Date.now() - start) / 1000;
    const told = {
      frames_per_page_per_s: (this.frames - frames) / (count - 1) / took_s,
      open: this.sockets.filter((socket) => socket.readyState === WebSocket.OPEN).length,
      overseer_cpu: (this.overseer.cpu_s() - cpu_s) / took_s,
      rss_MB: { before: rss_before, settled, end: this.overseer.rss_MB() },
    };
    for (const socket of this.sockets) socket.terminate();
    this.stalled.destroy();
    await pause(2000);
    const after = await this.#frame_ms(Math.max(5, this.for_s / 2));
    return { ...told, frame_ms: { before, during, after } };
  }
}
