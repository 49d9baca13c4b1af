// Many pages at one overseer, one of which does not read: what it costs the nodes and the overseer.
import net from "node:net";
import { pause } from "./real_run.mjs";
import WebSocket from "ws";

const STIR_EACH_S = 15;

const median = (numbers) => [...numbers].sort((a, b) => a - b)[Math.floor(numbers.length / 2)];

export class Crowd {
  /**
   * @param {import("./real_run.mjs").Program & {url: string}} overseer
   * @param {import("./real_run.mjs").Witness} witness
   * @param {() => Promise<unknown>} stir makes bodies move; a world at rest sends nothing
   */
  constructor(overseer, witness, stir, for_s) {
    Object.assign(this, { overseer, witness, stir, for_s, frames: 0, sockets: [] });
  }

  #join() {
    const socket = new WebSocket(`${this.overseer.url.replace("http", "ws")}ws`);
    socket.on("message", (_, isBinary) => { this.frames += isBinary ? 1 : 0; });
    socket.on("error", () => {});
    this.sockets.push(socket);
  }

  /** Asks for the WebSocket and then reads nothing. */
  #joinStalled() {
    this.stalled?.destroy();
    const { hostname, port, host } = new URL(this.overseer.url);
    this.stalled = net.connect(Number(port), hostname);
    this.stalled.on("error", () => {});
    this.stalled.write(`GET /ws HTTP/1.1\r\nHost: ${host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n`
      + "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n");
    this.stalled.pause();
  }

  /** What the overseer counts of its pages: {clients, frames_skipped_total, dropped_total, ...}. */
  async #web() {
    const text = await (await fetch(`${this.overseer.url}metrics`)).text();
    return Object.fromEntries([...text.matchAll(/^aurasim_web_(\w+) (\S+)$/gm)].map(([, name, value]) => [name, Number(value)]));
  }

  /**
   * The slowest region's frame times, asked for once a second: the medians of its p50 and of its p99, and of all
   * regions' awake bodies. The page that does not read comes again each time that it has been dropped.
   */
  async #frame_ms(for_s, stalled = false) {
    const p50 = [], p99 = [], awake = [];
    let { dropped_total } = await this.#web();
    for (let i = 0; i < for_s; ++i) {
      if (i % STIR_EACH_S === 0) await this.stir();
      await pause(1000);
      const told = await this.witness.metrics();
      p50.push(Math.max(...told.frame_p50_ms));
      p99.push(Math.max(...told.frame_p99_ms));
      awake.push(told.awake_bodies.reduce((sum, n) => sum + n, 0));
      const web = stalled ? await this.#web() : { dropped_total };
      if (web.dropped_total > dropped_total) this.#joinStalled();
      dropped_total = web.dropped_total;
    }
    return { p50: median(p50), p99: median(p99), awake: median(awake) };
  }

  async measure(count) {
    const before = await this.#frame_ms(Math.max(5, this.for_s / 2));
    const rss_before = this.overseer.rss_MB();
    const web_before = await this.#web();
    for (let i = 1; i < count; ++i) this.#join();
    this.#joinStalled();
    await pause(4000);
    const joined = (await this.#web()).clients - web_before.clients;
    const [settled, frames, cpu_s, start] = [this.overseer.rss_MB(), this.frames, this.overseer.cpu_s(), Date.now()];
    const during = await this.#frame_ms(this.for_s, true);
    const took_s = (Date.now() - start) / 1000;
    const web = await this.#web();
    const told = {
      frames_per_page_per_s: (this.frames - frames) / (count - 1) / took_s,
      joined,
      open: this.sockets.filter((socket) => socket.readyState === WebSocket.OPEN).length,
      dropped: web.dropped_total - web_before.dropped_total,
      frames_skipped: web.frames_skipped_total - web_before.frames_skipped_total,
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
