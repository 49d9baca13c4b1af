// A world that only looks like physics: bodies bounce, spin, fall asleep, are thrown up again, and change hosts when
// they cross a border. For working on the page without a run; nothing here is computed right.

export const STEP_S = 1 / 60;
const GRAVITY = -9.81;

/** Randomness that is the same in every run. */
function generator(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

const sphere = (radius) => ({ kind: "sphere", radius });
const box = (...half_extents) => ({ kind: "box", half_extents });
const OCTAHEDRON = { kind: "mesh", points: [0.5, 0, 0, -0.5, 0, 0, 0, 0.5, 0, 0, -0.5, 0, 0, 0, 0.6, 0, 0, -0.6],
  triangles: [0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5] };
const PYRAMID = { kind: "mesh", points: [-3, -3, 0, 3, -3, 0, 3, 3, 0, -3, 3, 0, 0, 0, 2.6], triangles: [0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4] };

export const SHAPES = [
  { name: "ball", ...sphere(0.35) }, { name: "cuboid", ...box(0.25, 0.25, 0.45) },
  { name: "capsule", kind: "capsule", radius: 0.25, height: 0.6 }, { name: "drum", kind: "cylinder", radius: 0.35, height: 0.7 },
  { name: "gem", ...OCTAHEDRON },
  { name: "dumbbell", kind: "compound", parts: [{ shape: sphere(0.32), p: [0, 0, 0.55], q: [1, 0, 0, 0] },
    { shape: sphere(0.32), p: [0, 0, -0.55], q: [1, 0, 0, 0] },
    { shape: { kind: "cylinder", radius: 0.1, height: 1.1 }, p: [0, 0, 0], q: [1, 0, 0, 0] }] },
  { name: "brick", ...box(0.4, 0.4, 0.25) },
  { name: "ground", kind: "plane", normal: [0, 0, 1], offset: 0 }, { name: "ramp", ...box(3, 2, 0.15) },
  { name: "block", ...box(1.2, 1.2, 1.2) }, { name: "pyramid", ...PYRAMID },
];
const RESTS_AT = [0.35, 0.25, 0.25, 0.35, 0.45, 0.32, 0.25];

/** So many columns and rows of 12 m, the outermost without an end. */
function gridOfRegions(count) {
  const edge = (i) => (i === 0 ? -Infinity : i === count ? Infinity : (i - count / 2) * 12);
  const indices = [...Array(count).keys()];
  return indices.flatMap((row) => indices.map((column) => [edge(column), edge(row), edge(column + 1), edge(row + 1)]));
}

export class MockWorld {
  /** @param {{bodies?: number, nodes?: number, reach?: number, seed?: number}} options  nodes: a square number */
  constructor({ bodies = 300, nodes = 4, reach = bodies > 2000 ? 75 : 18, seed = 7 } = {}) {
    Object.assign(this, { wanted: bodies, nodes, reach, seed });
    this.generation = 0;
    this.reset();
  }

  reset() {
    this.random = generator(this.seed);
    this.generation += 1;
    this.step = 0;
    this.bodies = new Map(); // slot -> body
    this.freeSlots = [];
    this.nextSlot = this.nextId = 0;
    this.shapes = [...SHAPES];
    this.prototypes = SHAPES.slice(0, 7).map((shape, i) => ({ name: shape.name, shape: i, mass_kg: 1 }));
    this.statics = [
      { id: 0, name: "ground", shape: 7, p: [0, 0, 0], q: [1, 0, 0, 0] },
      { id: 1, name: "ramp", shape: 8, p: [-9, 6, 1.1], q: [Math.cos(0.18), 0, Math.sin(0.18), 0] },
      { id: 2, name: "block", shape: 9, p: [9, -8, 1.2], q: [Math.cos(0.3), 0, 0, Math.sin(0.3)] },
      { id: 3, name: "pyramid", shape: 10, p: [10, 9, 0], q: [1, 0, 0, 0] }];
    this.regions = gridOfRegions(Math.round(Math.sqrt(this.nodes)));
    this.handOffs = this.regions.map(() => 0);
    this.#forgetChanges();
    const stacked = Math.min(96, this.wanted >> 2);
    for (let i = 0; i < stacked; ++i) this.#stackBrick(i);
    while (this.bodies.size < this.wanted) this.#throwIn();
  }

  #forgetChanges() {
    this.changes = { deleted: [], created: [], hosts: new Set(), handed: new Set(), moved: new Set() };
  }

  #stackBrick(i) {
    const [stack, at] = [i % 2, i >> 1];
    const [column, row] = [at % 4, at >> 2];
    const side = stack ? 1.6 : -1.6;
    const p = [side + (column % 2) * 0.84, side + (column >> 1) * 0.84, 0.25 + row * 0.5];
    this.add({ prototype: 6, p, v: [0, 0, 0], w: [0, 0, 0], still: true });
  }

  #throwIn() {
    const { random, reach } = this;
    const p = [0, 1].map(() => (random() * 2 - 1) * reach);
    const v = [0, 1].map(() => (random() * 2 - 1) * 7);
    this.add({ prototype: Math.floor(random() * 6), p: [...p, 0.5 + random() * 9], v: [...v, random() * 6],
      w: [0, 1, 2].map(() => (random() * 2 - 1) * 5), q: unit([random() - 0.5, random() - 0.5, random() - 0.5, random() - 0.5]) });
  }

  add({ prototype, p, v = [0, 0, 0], w = [0, 0, 0], q = [1, 0, 0, 0], still = false }) {
    const slot = this.freeSlots.pop() ?? this.nextSlot++;
    const body = { slot, id: this.nextId++, prototype, p: [...p], q: [...q], v: [...v], w: [...w], still, asleep: still, slept: 0,
      host: this.regionAt(p), epoch: 0, low: RESTS_AT[prototype] ?? 0.4 };
    this.bodies.set(slot, body);
    this.changes.created.push({ slot, prototype, id: body.id });
    this.changes.hosts.add(slot);
    this.changes.moved.add(slot);
    return body;
  }

  remove(slot) {
    this.bodies.delete(slot);
    this.freeSlots.push(slot);
    this.changes.deleted.push(slot);
    this.changes.created = this.changes.created.filter((c) => c.slot !== slot);
    for (const set of [this.changes.hosts, this.changes.moved, this.changes.handed]) set.delete(slot);
  }

  byId(id) {
    return [...this.bodies.values()].find((body) => body.id === id);
  }

  regionAt([x, y]) {
    return Math.max(0, this.regions.findIndex(([x0, y0, x1, y1]) => x >= x0 && x < x1 && y >= y0 && y < y1));
  }

  advance() {
    ++this.step;
    for (const body of this.bodies.values()) this.#advanceBody(body);
    // Now and then one goes and another comes, so that slots are given out again.
    if (this.step % 30 === 0) {
      const old = [...this.bodies.values()].find((body) => !body.still);
      if (old) this.remove(old.slot);
      this.#throwIn();
    }
  }

  #advanceBody(body) {
    if (body.asleep) {
      if (!body.still && ++body.slept > 240 && this.random() < 0.01) this.#wake(body, [this.random() * 10 - 5, this.random() * 10 - 5, 5 + this.random() * 5]);
      return;
    }
    body.v[2] += GRAVITY * STEP_S;
    for (let i = 0; i < 3; ++i) body.p[i] += body.v[i] * STEP_S;
    for (let i = 0; i < 2; ++i) {
      if (Math.abs(body.p[i]) > this.reach && body.p[i] * body.v[i] > 0) body.v[i] *= -1;
    }
    if (body.p[2] < body.low && body.v[2] < 0) this.#bounce(body);
    spin(body.q, body.w);
    this.changes.moved.add(body.slot);
    const region = this.regionAt(body.p);
    if (region !== body.host) this.#handOver(body, region);
  }

  #bounce(body) {
    body.p[2] = body.low;
    body.v[2] *= -0.62;
    for (const list of [body.w, body.v]) for (let i = 0; i < 2; ++i) list[i] *= 0.86;
    if (Math.hypot(...body.v) > 1) return;
    body.asleep = true;
    body.slept = 0;
    body.v = [0, 0, 0];
    this.changes.hosts.add(body.slot);
  }

  #wake(body, v) {
    body.asleep = body.still = false;
    body.v = v;
    this.changes.hosts.add(body.slot);
  }

  push(body, dv) {
    this.#wake(body, body.v.map((x, i) => x + dv[i]));
    if (Math.hypot(...body.w) < 0.1) body.w = [1, 2, 0];
  }

  steer(body, v) {
    this.#wake(body, [...v]);
  }

  #handOver(body, region) {
    ++this.handOffs[body.host % this.handOffs.length];
    body.host = region;
    ++body.epoch;
    this.changes.hosts.add(body.slot);
    this.changes.handed.add(body.slot);
  }

  setRegions(boxes) {
    this.regions = boxes.map(([x0, y0, x1, y1]) => [x0 ?? -Infinity, y0 ?? -Infinity, x1 ?? Infinity, y1 ?? Infinity]);
    for (const body of this.bodies.values()) {
      const region = this.regionAt(body.p);
      if (region !== body.host) this.#handOver(body, region);
    }
  }

  #hostEntry(body, handed) {
    return { slot: body.slot, host: body.host, flags: (body.asleep ? 1 : 0) | (handed ? 4 : 0), epoch: body.epoch };
  }

  keyFrame() {
    const all = [...this.bodies.values()];
    return { key: true, generation: this.generation, stamp: this.step, created: all.map(({ slot, prototype, id }) => ({ slot, prototype, id })),
      hosts: all.map((body) => this.#hostEntry(body, false)), moved: all };
  }

  /** What changed since the last call. */
  takeFrame() {
    const { deleted, created, hosts, handed, moved } = this.changes;
    this.#forgetChanges();
    const body = (slot) => this.bodies.get(slot);
    return { generation: this.generation, stamp: this.step, deleted, created,
      hosts: [...hosts].map((slot) => this.#hostEntry(body(slot), handed.has(slot))), moved: [...moved].map(body) };
  }

  overlay() {
    const awake = [...this.bodies.values()].filter((body) => !body.asleep);
    const near = awake.filter((body) => Math.min(Math.abs(body.p[0]), Math.abs(body.p[1])) < 4);
    const pairs = (list) => list.slice(1).map((body, i) => [list[i].slot, body.slot]);
    const bricks = [...this.bodies.values()].filter((body) => body.still);
    return { auras: near.map((body) => [body.slot, 0.8 + Math.hypot(...body.v) * 0.12]), links: pairs(near.slice(0, 24)), contacts: pairs(bricks) };
  }
}

function spin(q, [wx, wy, wz]) {
  const half = STEP_S / 2;
  const [w, x, y, z] = q;
  q[0] -= half * (wx * x + wy * y + wz * z);
  q[1] += half * (wx * w + wy * z - wz * y);
  q[2] += half * (wy * w + wz * x - wx * z);
  q[3] += half * (wz * w + wx * y - wy * x);
  const length = Math.hypot(...q);
  for (let i = 0; i < 4; ++i) q[i] /= length;
}

function unit(q) {
  const length = Math.hypot(...q) || 1;
  return q.map((x) => x / length);
}
