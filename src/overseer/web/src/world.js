// The bodies that the page knows, by slot, with their last few states for interpolation. Pure: no drawing, no clock.
import { ASLEEP, BYTE_LEVELS, BYTE_STEPS, GRID_M, JUST_HANDED_OVER, UNDER_WAY, WHOLE_POSITION, WHOLE_ROTATION, WORD_STEPS, turnPacked,
  unpackRotation } from "./frames.js";

/** States kept per body. Four span three intervals: more than the picture is behind. */
const RING = 4;

/** How a frame changed the world, for whoever draws it. */
const nothingChanged = () => ({ cleared: false, added: [], removed: [], rehosted: [], handedOver: [] });

const pose = { p: new Float64Array(3), q: new Float32Array(4) };

export class World {
  constructor(capacity = 256) {
    this.#allocate(capacity);
    this.clear();
    /** Since the page was opened; `duplicates`: ids that were created while another slot had them. */
    this.counts = { frames: 0, created: 0, deleted: 0, duplicates: 0, handOffs: 0, ignored: 0 };
  }

  #allocate(capacity) {
    const grown = (old, Type, size) => {
      const array = new Type(capacity * size);
      if (old) array.set(old);
      return array;
    };
    this.alive = grown(this.alive, Uint8Array, 1);
    this.id = grown(this.id, Float64Array, 1);
    this.prototype = grown(this.prototype, Uint32Array, 1);
    this.host = grown(this.host, Uint16Array, 1);
    this.flags = grown(this.flags, Uint16Array, 1);
    this.epoch = grown(this.epoch, Uint32Array, 1);
    this.head = grown(this.head, Uint8Array, 1);
    this.held = grown(this.held, Uint8Array, 1);
    this.toldP = grown(this.toldP, Float64Array, 3); // in GRID_M: what the next difference is added to
    this.toldQ = grown(this.toldQ, Uint32Array, 1);
    this.stamps = grown(this.stamps, Float64Array, RING);
    this.ringP = grown(this.ringP, Float64Array, RING * 3);
    this.ringQ = grown(this.ringQ, Float32Array, RING * 4);
    this.capacity = capacity;
  }

  /** Forget every body: a new connection, a key frame. */
  clear() {
    this.alive?.fill(0);
    this.slotOfId = new Map();
    this.size = 0;
    this.stamp = NaN;
    this.generation = NaN;
  }

  /**
   * @param {import("./frames.js").Frame} frame
   */
  apply(frame) {
    const change = nothingChanged();
    ++this.counts.frames;
    if (frame.key || (this.generation === this.generation && frame.generation !== this.generation)) {
      this.clear();
      change.cleared = true;
    }
    this.generation = frame.generation;
    const previous = this.stamp;
    this.stamp = frame.stamp;
    for (const slot of frame.deleted) if (this.#remove(slot)) change.removed.push(slot);
    for (const body of frame.created) this.#create(body, change);
    for (const entry of frame.hosts) this.#rehost(entry, change);
    this.#move(frame, previous);
    return change;
  }

  #remove(slot) {
    if (!this.isAlive(slot)) {
      ++this.counts.ignored;
      return false;
    }
    this.alive[slot] = 0;
    if (this.slotOfId.get(this.id[slot]) === slot) this.slotOfId.delete(this.id[slot]);
    --this.size;
    ++this.counts.deleted;
    return true;
  }

  #create({ slot, prototype, id }, change) {
    if (slot >= this.capacity) this.#allocate(Math.max(slot + 1, this.capacity * 2));
    // A slot that is given out again without having been deleted: the last word counts.
    if (this.alive[slot] && this.#remove(slot)) change.removed.push(slot);
    const other = this.slotOfId.get(id);
    if (other !== undefined) {
      ++this.counts.duplicates;
      if (this.#remove(other)) change.removed.push(other);
    }
    this.alive[slot] = 1;
    this.id[slot] = id;
    this.prototype[slot] = prototype;
    this.host[slot] = this.flags[slot] = this.epoch[slot] = this.head[slot] = this.held[slot] = 0;
    this.toldP.fill(0, 3 * slot, 3 * slot + 3);
    this.toldQ[slot] = 0;
    this.slotOfId.set(id, slot);
    ++this.size;
    ++this.counts.created;
    change.added.push(slot);
  }

  #rehost({ slot, host, flags, epoch }, change) {
    if (!this.isAlive(slot)) return void ++this.counts.ignored;
    if (flags & JUST_HANDED_OVER) {
      ++this.counts.handOffs;
      change.handedOver.push(slot);
    }
    this.host[slot] = host;
    this.flags[slot] = flags;
    this.epoch[slot] = epoch;
    change.rehosted.push(slot);
  }

  #move(frame, previous) {
    const { movedSlots } = frame;
    for (let i = 0; i < movedSlots.length; ++i) {
      const slot = movedSlots[i];
      if (!this.isAlive(slot)) {
        ++this.counts.ignored;
        continue;
      }
      this.#take(frame, i, slot);
      const head = this.head[slot];
      if (this.held[slot] > 0 && this.stamps[slot * RING + head] < previous) {
        // It was at rest until the previous frame. Without this it would seem to have drifted since its last one.
        this.#push(slot, previous, this.ringP, (slot * RING + head) * 3, this.ringQ, (slot * RING + head) * 4);
      }
      this.#push(slot, frame.stamp, pose.p, 0, pose.q, 0);
    }
  }

  /** What row `i` makes of the pose that was told last, into `pose`. */
  #take({ movedHow, movedP, movedQ }, i, slot) {
    const position = movedHow[i] & 3, rotation = movedHow[i] >> 2;
    for (let axis = 0; axis < 3; ++axis) {
      const at = 3 * slot + axis;
      if (position === BYTE_STEPS || position === WORD_STEPS) this.toldP[at] += movedP[3 * i + axis];
      else if (position === WHOLE_POSITION) this.toldP[at] = movedP[3 * i + axis];
      pose.p[axis] = this.toldP[at] * GRID_M;
    }
    if (rotation === WHOLE_ROTATION) this.toldQ[slot] = movedQ[3 * i];
    else if (rotation === BYTE_LEVELS) this.toldQ[slot] = turnPacked(this.toldQ[slot], movedQ, 3 * i);
    unpackRotation(this.toldQ[slot], pose.q);
  }

  #push(slot, stamp, p, pAt, q, qAt) {
    const held = this.held[slot];
    const newest = slot * RING + this.head[slot];
    let head = held === 0 ? 0 : (this.head[slot] + 1) % RING;
    if (held > 0 && this.stamps[newest] >= stamp) {
      // The same stamp again replaces; time that went back (a seek) makes the older states meaningless.
      head = this.head[slot];
      if (this.stamps[newest] > stamp) this.held[slot] = 1;
    } else {
      this.held[slot] = Math.min(RING, held + 1);
    }
    this.head[slot] = head;
    const at = slot * RING + head;
    this.stamps[at] = stamp;
    for (let i = 0; i < 3; ++i) this.ringP[at * 3 + i] = p[pAt + i];
    for (let i = 0; i < 4; ++i) this.ringQ[at * 4 + i] = q[qAt + i];
  }

  isAlive(slot) {
    return slot < this.capacity && this.alive[slot] === 1;
  }

  isAsleep(slot) {
    return (this.flags[slot] & ASLEEP) !== 0;
  }

  isUnderWay(slot) {
    return (this.flags[slot] & UNDER_WAY) !== 0;
  }

  /** Will it look the same at every later stamp, until a frame moves it? */
  isSettled(slot, stamp) {
    return this.held[slot] > 0 && stamp >= this.stamps[slot * RING + this.head[slot]];
  }

  /**
   * State of a body at a stamp: between its two nearest states, its oldest or newest beyond them.
   * @param {{p: ArrayLike<number>, q: ArrayLike<number>}} out  p [3] in the world, q [4] w x y z
   * @returns {boolean} false if nothing is known of it
   */
  sample(slot, stamp, out) {
    const held = this.held[slot];
    if (!this.isAlive(slot) || held === 0) return false;
    let later = slot * RING + this.head[slot];
    if (held === 1 || !(stamp < this.stamps[later])) return this.#copy(later, out);
    for (let back = 1; back < held; ++back) {
      const earlier = slot * RING + ((this.head[slot] - back + RING) % RING);
      if (this.stamps[earlier] <= stamp) {
        return this.#between(earlier, later, stamp, out);
      }
      later = earlier;
    }
    return this.#copy(later, out);
  }

  #copy(at, out) {
    for (let i = 0; i < 3; ++i) out.p[i] = this.ringP[at * 3 + i];
    for (let i = 0; i < 4; ++i) out.q[i] = this.ringQ[at * 4 + i];
    return true;
  }

  #between(earlier, later, stamp, out) {
    const span = this.stamps[later] - this.stamps[earlier];
    const t = span > 0 ? (stamp - this.stamps[earlier]) / span : 1;
    for (let i = 0; i < 3; ++i) {
      out.p[i] = this.ringP[earlier * 3 + i] * (1 - t) + this.ringP[later * 3 + i] * t;
    }
    slerp(this.ringQ, earlier * 4, later * 4, t, out.q);
    return true;
  }

  /** Velocity by finite differences of its last two states, m per step. @returns {boolean} false if it is at rest */
  velocity(slot, out) {
    const newest = slot * RING + this.head[slot];
    const before = slot * RING + ((this.head[slot] - 1 + RING) % RING);
    const span = this.stamps[newest] - this.stamps[before];
    if (this.held[slot] < 2 || !(span > 0) || this.stamps[newest] < this.stamp) return false;
    for (let i = 0; i < 3; ++i) out[i] = (this.ringP[newest * 3 + i] - this.ringP[before * 3 + i]) / span;
    return true;
  }

  /** Newest position, for tests and for the camera. @returns {number[]} */
  position(slot) {
    const at = (slot * RING + this.head[slot]) * 3;
    return [this.ringP[at], this.ringP[at + 1], this.ringP[at + 2]];
  }

  /** @yields {number} slots in use */
  *slots() {
    for (let slot = 0; slot < this.capacity; ++slot) if (this.alive[slot]) yield slot;
  }
}

/** The short way round; nearly equal rotations are mixed linearly. Writes w x y z into `out`. */
export function slerp(q, a, b, t, out) {
  let cosine = 0;
  for (let i = 0; i < 4; ++i) cosine += q[a + i] * q[b + i];
  const sign = cosine < 0 ? -1 : 1;
  cosine = Math.min(1, Math.abs(cosine));
  let [wa, wb] = [1 - t, t];
  if (cosine < 0.9995) {
    const angle = Math.acos(cosine);
    const sine = Math.sin(angle);
    wa = Math.sin((1 - t) * angle) / sine;
    wb = Math.sin(t * angle) / sine;
  }
  let length = 0;
  for (let i = 0; i < 4; ++i) {
    out[i] = wa * q[a + i] + sign * wb * q[b + i];
    length += out[i] * out[i];
  }
  length = Math.sqrt(length) || 1;
  for (let i = 0; i < 4; ++i) out[i] /= length;
}
