// An overseer that only pretends: serves the built page and speaks docs/viewer.md for a made-up world of a few regions.
// For development and for the test of the page alone.
//   node mock_overseer.mjs [--port 8080] [--bodies 300] [--nodes 4] [--token SECRET] [--view-token SECRET] [--replay]
import { readFileSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";
import { WebSocketServer } from "ws";
import { writeFrame, writeOverlay } from "./frame_writer.mjs";
import { MockWorld, STEP_S } from "./mock_world.mjs";

const DIST = fileURLToPath(new URL("../../src/overseer/web/dist/", import.meta.url));
/** What the overseer allows the page to load and to do: the page has to live with that here, too. */
const POLICY = [.../kContentPolicy =([^;]*(?:"[^"]*"\s*)+);/.exec(readFileSync(new URL("../../src/overseer/web_headers.h", import.meta.url), "utf8"))[1]
  .matchAll(/"([^"]*)"/g)].map(([, part]) => part).join("");
const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml" };
const STEPS_PER_FRAME = 3; // 20 frames a second
const SCENES = ["corner_stacks", "columns_rain", "falling_piles", "tower"];
const LAST_REPLAY_STEP = 3600;

export class MockOverseer {
  constructor({ port = 0, bodies = 300, nodes = 4, token = "", viewToken = "", replay = false, exchange = "aura", dist = DIST } = {}) {
    Object.assign(this, { port, token, viewToken, replay, exchange, dist });
    this.late = 0; // collisions that region 1 says were late
    this.world = new MockWorld({ bodies, nodes });
    this.commands = []; // everything that clients sent, for tests
    this.requests = []; // and every address that they asked for
    this.clients = new Map(); // socket -> {show, watch}
    this.state = "running";
    this.rate = this.speed = 1;
    this.scene = SCENES[0];
    this.stepsDue = 0;
  }

  /** @returns {Promise<string>} the address of the page */
  async start() {
    this.http = createServer((request, response) => this.#serve(request, response));
    this.sockets = new WebSocketServer({ server: this.http, path: "/ws", verifyClient: ({ req }) => this.#may(req) !== "nothing" });
    this.sockets.on("connection", (socket, request) => this.#greet(socket, this.#may(request)));
    await new Promise((resolve, reject) => this.http.once("error", reject).listen(this.port, "127.0.0.1", resolve));
    this.port = this.http.address().port;
    this.last_ms = performance.now();
    this.timers = [setInterval(() => this.#tick(), 1000 * STEP_S * STEPS_PER_FRAME), setInterval(() => this.#status(), 250)];
    return `http://127.0.0.1:${this.port}/`;
  }

  async stop() {
    this.timers.forEach(clearInterval);
    for (const socket of this.clients.keys()) socket.terminate();
    this.sockets.close();
    this.http.closeAllConnections();
    await new Promise((resolve) => this.http.close(resolve));
  }

  /** By its token or its cookie, as docs/viewer.md has it. */
  #may(request) {
    const shown = request.headers.authorization?.replace("Bearer ", "");
    const cookie = /mock=(\w+)/.exec(request.headers.cookie ?? "")?.[1];
    if (!this.token || shown === this.token || cookie === "operate") return "operate";
    return !this.viewToken || shown === this.viewToken || cookie === "look" ? "look" : "nothing";
  }

  #session(request, response) {
    const shown = request.headers.authorization;
    const wrong = shown !== undefined && shown !== `Bearer ${this.token}` && shown !== `Bearer ${this.viewToken}`;
    if (wrong) return response.writeHead(401).end("the token is missing or wrong");
    const may = this.#may(request);
    if (request.method === "POST") response.setHeader("Set-Cookie", `mock=${may}; Path=/; HttpOnly; SameSite=Strict`);
    response.writeHead(200, { "Content-Type": "application/json" }).end(JSON.stringify({ may }));
  }

  async #serve(request, response) {
    const url = new URL(request.url, "http://localhost");
    response.setHeader("Content-Security-Policy", POLICY);
    this.requests.push(request.url);
    const json = (code, body) => response.writeHead(code, { "Content-Type": "application/json" }).end(JSON.stringify(body));
    if (url.pathname === "/healthz") return response.end("ok");
    if (url.pathname === "/api/session") return this.#session(request, response);
    if (url.pathname === "/api/scenes") return json(200, { scenes: SCENES });
    if (url.pathname === "/api/shapes") {
      if (this.#may(request) !== "operate") return json(401, { text: "the token is missing or wrong" });
      let bytes = 0;
      for await (const chunk of request) bytes += chunk.length;
      this.commands.push({ kind: "upload", name: url.searchParams.get("name"), bytes });
      return json(200, { hash: "0123456789abcdef", points: 8, triangles: 12 });
    }
    const path = normalize(url.pathname === "/" ? "/index.html" : url.pathname);
    try {
      const body = await readFile(join(this.dist, path));
      response.writeHead(200, { "Content-Type": TYPES[extname(path)] ?? "application/octet-stream" }).end(body);
    } catch {
      response.writeHead(404).end("no such file");
    }
  }

  #greet(socket, may) {
    this.clients.set(socket, { show: {}, watch: null, may });
    socket.on("close", () => this.clients.delete(socket));
    socket.on("message", (data) => this.#receive(socket, JSON.parse(String(data))));
    this.#say(socket, { type: "hello", version: 1, mode: this.replay ? "replay" : "live", scene: this.scene, step_s: STEP_S, tick_hz: 20,
      ...(this.replay ? { first: 0, last: LAST_REPLAY_STEP, resets: [LAST_REPLAY_STEP / 3] } : {}) });
    this.#say(socket, this.#sceneMessage());
    this.#say(socket, this.#mapMessage());
    // Others have not had the latest changes yet; whoever comes now has them in the key frame.
    const before = this.world.takeFrame();
    for (const other of this.clients.keys()) if (other !== socket) other.send(writeFrame(before));
    socket.send(writeFrame(this.world.keyFrame()));
  }

  #say(socket, message) {
    socket.send(JSON.stringify(message));
  }

  #sayAll(message) {
    for (const socket of this.clients.keys()) this.#say(socket, message);
  }

  #sceneMessage() {
    const { generation, shapes, prototypes, statics } = this.world;
    return { type: "scene", generation, name: this.scene, gravity: [0, 0, -9.81], shapes, prototypes, statics };
  }

  #mapMessage() {
    const finite = (x) => (Number.isFinite(x) ? x : null);
    const regions = this.world.regions.map(([x0, y0, x1, y1], id) => ({ id, x0: finite(x0), y0: finite(y0), x1: finite(x1), y1: finite(y1) }));
    return { type: "map", map_version: "1", regions };
  }

  #tick() {
    const now_ms = performance.now();
    if (this.state === "running") this.stepsDue += ((now_ms - this.last_ms) / 1000 / STEP_S) * this.rate * (this.replay ? this.speed : 1);
    this.last_ms = now_ms;
    const steps = Math.min(12, Math.floor(this.stepsDue));
    this.stepsDue -= Math.floor(this.stepsDue);
    for (let i = 0; i < steps; ++i) this.world.advance();
    const frame = writeFrame(this.world.takeFrame());
    for (const [socket, { show }] of this.clients) {
      if (socket.bufferedAmount > 4e6) socket.terminate();
      else socket.send(frame);
      if (show.auras || show.links || show.contacts) socket.send(writeOverlay(this.world.overlay()));
    }
  }

  #status() {
    this.#sayAll({ type: "status", step: this.world.step, state: this.state, rate: this.rate, clients: this.clients.size, nodes: this.#nodes() });
    if (this.replay) this.#sayAll({ type: "replay", at: this.world.step, step: this.world.step, playing: this.state === "running", speed: this.speed });
    for (const [socket, { watch }] of this.clients) {
      const body = this.world.bodies.get(watch);
      if (!body) continue;
      this.#say(socket, { type: "body", slot: watch, id: body.id, host: body.host, epoch: body.epoch, prototype: this.world.prototypes[body.prototype].name,
        p: body.p, q: body.q, v: body.v, w: body.w, speed: Math.hypot(...body.v), awake: !body.asleep });
    }
  }

  #nodes() {
    const wobble = (base, i) => base * (1 + 0.25 * Math.sin(this.world.step / 40 + i * 1.7) + 0.15 * Math.sin(this.world.step / 9 + i));
    return this.world.regions.map((_, region) => {
      const hosted = [...this.world.bodies.values()].filter((body) => body.host === region);
      const base = 1 + hosted.length * 0.018;
      const times = { p50: wobble(base, region), p99: wobble(base * 1.7, region + 2), max: wobble(base * 2.2, region) };
      return { region, step: this.world.step, state: this.state, lost: false, bodies: hosted.length, awake: hosted.filter((b) => !b.asleep).length,
        hand_offs_out: this.world.handOffs[region], hand_offs_in: this.world.handOffs[region], hand_offs_per_s: Math.max(0, wobble(6, region)),
        violations: { speed: 0, latency: 0, frame: region === 1 ? 3 : 0, promise: 0, span: 0 },
        late: region === 1 ? this.late : 0, missed: 0, frame_ms: times, physics_ms: times,
        protocol_ms: times, transport_ms: times, exchange: this.exchange, exchange_ms: this.exchange === "coupled" ? { p50: 0.06, p99: 0.2, max: 0.4 } : {}, real_time_factor: this.state === "running" ? this.rate : 0, largest_cluster: 48, lookahead: 2, text: "",
        listens_to: [{ region: (region + 1) % 4, since: 0 }, { region: (region + 2) % 4, since: 120, introduced_by: (region + 1) % 4 }] };
    });
  }

  #receive(socket, message) {
    const client = this.clients.get(socket);
    if (message.type === "show") client.show = message;
    if (message.type === "watch") client.watch = message.slot;
    if (message.type !== "command") this.commands.push({ kind: message.type, ...message });
    if (message.type === "replay") this.#replay(message);
    if (message.type !== "command") return;
    const answer = (ok, text = "", result = {}) => this.#say(socket, { type: "reply", request: message.request, ok, text, result });
    if (client.may !== "operate" && message.command.kind !== "ray") return answer(false, "this takes a token: the one for operators");
    this.commands.push(message.command);
    try {
      const result = this.#obey(message.command);
      answer(true, "", result ?? {});
    } catch (error) {
      answer(false, error.message);
    }
  }

  #replay({ action, value }) {
    if (action === "play" || action === "pause") this.state = action === "play" ? "running" : "paused";
    if (action === "speed") this.speed = value;
    if (action !== "seek") return;
    this.world.reset();
    for (let i = 0; i < value; ++i) this.world.advance();
    this.#restart();
  }

  #restart() {
    this.world.takeFrame();
    this.#sayAll(this.#sceneMessage());
    const key = writeFrame(this.world.keyFrame());
    for (const socket of this.clients.keys()) socket.send(key);
  }

  #obey(command) {
    const body = () => this.world.byId(command.body) ?? fail(`there is no body ${command.body}`);
    switch (command.kind) {
      case "pause": this.state = "paused"; return;
      case "resume": this.state = "running"; return;
      case "step": for (let i = 0; i < command.count; ++i) this.world.advance(); return;
      case "rate": this.rate = command.value > 0 && command.value <= 10 ? command.value : fail("rate: above 0, at most 10"); return;
      case "reset": this.world.reset(); return this.#restart();
      case "save": return;
      case "load": case "back": this.world.reset(); return this.#restart();
      case "scene": this.scene = SCENES.includes(command.name) ? command.name : fail("no such scene"); this.world.reset(); return this.#restart();
      case "regions": this.world.setRegions(command.boxes); return this.#sayAll(this.#mapMessage());
      case "spawn": return { body: this.world.add({ ...command, prototype: this.#prototypeOf(command) }).id };
      case "static": return this.#addStatic(command);
      case "remove":
        if (command.body !== undefined) return this.world.remove(body().slot);
        this.world.statics = this.world.statics.filter((s) => s.id !== command.static);
        return this.#sayAll(this.#sceneMessage());
      case "impulse": return this.world.push(body(), command.J);
      case "velocity": return this.world.steer(body(), command.v);
      case "ray": return this.#ray(command);
      default: return fail(`${command.kind} is not a command`);
    }
  }

  #shapeIndex(shape) {
    const half = (shape.size ?? [1, 1, 1]).map((side) => side / 2);
    const known = { name: shape.hash ? "upload" : "made", ...(shape.kind === "sphere" ? shape : { kind: "box", half_extents: half }) };
    return this.world.shapes.push(known) - 1;
  }

  #prototypeOf({ prototype, shape, mass }) {
    if (prototype !== undefined) return this.world.prototypes.findIndex((p) => p.name === prototype);
    const index = this.world.prototypes.push({ name: `made_${this.world.prototypes.length}`, shape: this.#shapeIndex(shape), mass_kg: mass }) - 1;
    this.#sayAll(this.#sceneMessage());
    return index;
  }

  #addStatic({ shape, p, q }) {
    const id = 1 + Math.max(...this.world.statics.map((s) => s.id));
    this.world.statics.push({ id, name: `made ${id}`, shape: this.#shapeIndex(shape), p, q });
    this.#sayAll(this.#sceneMessage());
    return { static: id };
  }

  /** Every body is taken for a ball of 0.5 m. */
  #ray({ from, to }) {
    const length = Math.hypot(...to.map((x, i) => x - from[i]));
    const direction = to.map((x, i) => (x - from[i]) / length);
    let best = { hit: false, body: null, static: null, p: to, normal: [0, 0, 1], distance: length, complete: true, silent_regions: [] };
    for (const body of this.world.bodies.values()) {
      const along = direction.reduce((sum, d, i) => sum + d * (body.p[i] - from[i]), 0);
      const p = from.map((x, i) => x + direction[i] * along);
      if (along > 0 && along < best.distance && Math.hypot(...p.map((x, i) => x - body.p[i])) < 0.5) {
        best = { ...best, hit: true, body: body.id, p, distance: along };
      }
    }
    if (!best.hit && direction[2] < 0) best = { ...best, hit: true, static: 0, distance: -from[2] / direction[2] };
    return best;
  }
}

function fail(text) {
  throw new Error(text);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const option = (name, otherwise) => {
    const at = process.argv.indexOf(`--${name}`);
    return at < 0 ? otherwise : process.argv[at + 1];
  };
  const mock = new MockOverseer({ port: Number(option("port", 8080)), bodies: Number(option("bodies", 300)),
    nodes: Number(option("nodes", 4)), token: option("token", ""), viewToken: option("view-token", ""),
    replay: process.argv.includes("--replay") });
  console.log(await mock.start());
}
