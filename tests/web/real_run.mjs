// A run of real processes for tests of the page: the nodes, the overseer whose page is looked at, and a second overseer
// as a witness, which hears on DDS what the nodes do and knows nothing of the page.
import { spawn } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import WebSocket from "ws";
import { decode } from "../../src/overseer/web/src/frames.js";
import { World } from "../../src/overseer/web/src/world.js";

export const ROOT = fileURLToPath(new URL("../..", import.meta.url));
const AURASIM = process.env.AURASIM ?? `${ROOT}build/release/aurasim`;

export const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
export const seconds = (name, fallback) => Number(process.env[name] ?? fallback);

/** Asks until it holds; throws with `what` when it does not in time. Returns what the condition gave. */
export async function until(condition, what, timeout_ms = 20000) {
  const deadline = Date.now() + timeout_ms;
  for (;;) {
    const held = await condition();
    if (held) return held;
    if (Date.now() > deadline) throw new Error(`not within ${timeout_ms} ms: ${typeof what === "function" ? what() : what}`);
    await pause(30);
  }
}

const running = new Set();
const killAll = () => {
  for (const program of running) program.kill();
};
process.on("exit", killAll);
for (const signal of ["SIGINT", "SIGTERM", "SIGHUP"]) process.on(signal, () => process.exit(1));

/** Nothing that is tested here may hang whoever runs the tests. */
export function endAfter(limit_s) {
  setTimeout(() => {
    console.error(`the tests have not ended after ${limit_s} s`);
    process.exit(1);
  }, limit_s * 1000).unref();
}

/** A process in a group of its own, its output kept, ended by its id. */
export class Program {
  constructor(words, command = AURASIM) {
    this.words = words;
    this.out = "";
    this.process = spawn(command, words, { detached: true, stdio: ["ignore", "pipe", "pipe"] });
    this.pid = this.process.pid;
    this.code = null;
    for (const stream of [this.process.stdout, this.process.stderr]) {
      stream.on("data", (data) => { this.out = (this.out + data).slice(-20000); });
    }
    this.ended = new Promise((resolve) => {
      this.process.on("close", (code, signal) => {
        running.delete(this);
        resolve((this.code = code ?? signal));
      });
    });
    running.add(this);
  }

  /** Of this process and what it has started, from the outside in. */
  pids() {
    const found = [this.pid];
    for (const pid of found) {
      try {
        found.push(...readFileSync(`/proc/${pid}/task/${pid}/children`, "utf8").split(" ").filter(Boolean).map(Number));
      } catch {
        // It has just ended.
      }
    }
    return found;
  }

  kill() {
    if (this.code !== null) return;
    for (const pid of this.pids().reverse()) {
      try {
        process.kill(pid, "SIGKILL");
      } catch {
        // It has just ended.
      }
    }
  }

  async end(signal = "SIGINT", patience_ms = 10000) {
    if (this.code === null) this.process.kill(signal);
    await Promise.race([this.ended, pause(patience_ms)]);
    this.kill();
    return this.ended;
  }

  rss_MB() {
    return Number(/VmRSS:\s+(\d+) kB/.exec(readFileSync(`/proc/${this.pid}/status`, "utf8"))[1]) / 1024;
  }

  cpu_s() {
    const fields = readFileSync(`/proc/${this.pid}/stat`, "utf8").split(") ")[1].split(" ");
    return (Number(fields[11]) + Number(fields[12])) / 100;
  }
}

/** What an overseer says, read without a browser. */
export class Witness {
  constructor(url) {
    this.url = url;
    this.world = new World();
    this.latest = {};
    this.socket = new WebSocket(`${url.replace("http", "ws")}ws`);
    this.socket.binaryType = "arraybuffer";
    this.socket.on("message", (data, isBinary) => this.#read(data, isBinary));
    this.socket.on("error", () => {});
  }

  #read(data, isBinary) {
    if (!isBinary) {
      const message = JSON.parse(data.toString());
      this.latest[message.type] = message;
      return;
    }
    const message = decode(data);
    if (message.kind === "overlay") this.overlay = message;
    else this.world.apply(message);
  }

  get ids() { return [...this.world.slots()].map((slot) => this.world.id[slot]); }
  get status() { return this.latest.status; }
  has(id) { return this.world.slotOfId.has(id); }
  position(id) { return this.world.position(this.world.slotOfId.get(id)); }

  /** The body as the nodes tell it, with its velocity. */
  async body(id) {
    delete this.latest.body;
    this.socket.send(JSON.stringify({ type: "watch", slot: this.world.slotOfId.get(id) }));
    return until(() => this.latest.body?.id === id && this.latest.body, `a word about body ${id}`, 4000);
  }

  /** What is drawn over the bodies: {auras, links, contacts}, each wanted or not. */
  show(what) {
    delete this.overlay;
    this.socket.send(JSON.stringify({ type: "show", auras: false, links: false, contacts: false, ...what }));
  }

  /** By name, the numbers of all regions. */
  async metrics() {
    const text = await (await fetch(`${this.url}metrics`)).text();
    const found = {};
    for (const [, name, value] of text.matchAll(/^aurasim_(\w+)\{region="\d+"\} (\S+)$/gm)) (found[name] ??= []).push(Number(value));
    return found;
  }

  async bodies() { return (await this.metrics()).bodies.reduce((sum, n) => sum + n, 0); }
  async steps() { return (await this.metrics()).step; }
  close() { this.socket.terminate(); }
}

export class RealRun {
  constructor(launch_file, domain) {
    this.file = `${ROOT}launch_configs/${launch_file}.yaml`;
    this.more = ["--set", `dds.domain=${domain}`];
    if (!existsSync(AURASIM)) throw new Error(`${AURASIM} has to be built first`);
  }

  async start(nodes) {
    // The run ends by itself should everything else that ends it fail.
    this.nodes = new Program(["launch", this.file, "--headless", "--duration", "900", ...this.more]);
    this.second = await this.overseer();
    this.witness = new Witness(this.second.url);
    await until(() => this.witness.status?.nodes.length === nodes && this.witness.world.size > 0,
      () => `a run of ${nodes} nodes: ${this.nodes.out}${this.second.out}`, 40000);
  }

  /** Returns once it listens. */
  async overseer(port = 0) {
    const overseer = new Program(["overseer", this.file, "--port", String(port), ...this.more]);
    overseer.url = await until(() => /http:\/\/127\.0\.0\.1:\d+\//.exec(overseer.out)?.[0], () => overseer.out, 10000);
    return overseer;
  }

  /** `aurasim send ...`: tells the nodes something over DDS, beside page and overseer. Returns its last word. */
  async send(...words) {
    const [what, ...options] = words.map(String);
    const program = new Program(["send", what, this.file, ...this.more, ...options]);
    const code = await Promise.race([program.ended, pause(20000)]);
    program.kill();
    if (code !== 0) throw new Error(`send ${words.join(" ")}: ${code} ${program.out}`);
    const line = program.out.trim().split("\n").at(-1);
    return line.startsWith("{") ? JSON.parse(line) : line;
  }

  /** What the nodes say is first from high above a point down to below the ground. */
  ray_down([x, y, z]) { return this.send("ray", "--from", x, y, z + 30, "--to", x, y, -5); }

  async end() {
    this.witness?.close();
    await this.second?.end("SIGTERM", 4000);
    return this.nodes?.end();
  }
}
