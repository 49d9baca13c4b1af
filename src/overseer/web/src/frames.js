// Reads the binary messages of the overseer (docs/viewer.md, "Frames"). Pure: bytes in, plain data out.
// What comes over the wire is checked and refused, with a reason; nothing here throws for bad bytes.

const VERSION = 2;
const FRAME = 1;
const OVERLAY = 2;
const FRAME_HEADER = 32;
const OVERLAY_HEADER = 16;

/** Metres: positions are whole numbers of this, so that no sum of them is rounded. */
export const GRID_M = 1 / 2048;
// How a pose is told: bits 0 and 1 of its head say how its position is, 2 and 3 how its rotation.
export const BYTE_STEPS = 1, WORD_STEPS = 2, WHOLE_POSITION = 3;
export const BYTE_LEVELS = 1, WHOLE_ROTATION = 2;
const FAR_SLOT = 15;

export const ASLEEP = 1;
export const UNDER_WAY = 2;
export const JUST_HANDED_OVER = 4;

// More slots than this are not believed: tables are sized by the largest slot.
const MAX_SLOTS = 1 << 20;

/**
 * @typedef {object} Frame
 * @property {"frame"} kind
 * @property {boolean} key  forget every body first
 * @property {number} generation
 * @property {number} stamp  in steps
 * @property {number} deletedCount
 * @property {number} createdCount
 * @property {number} hostsCount
 * @property {number} movedCount
 * @property {Uint32Array} deleted  slots
 * @property {{slot: number, prototype: number, id: number}[]} created
 * @property {{slot: number, host: number, flags: number, epoch: number}[]} hosts
 * @property {Uint32Array} movedSlots
 * @property {Uint8Array} movedHow  [n], bits as above
 * @property {Float64Array} movedP  [n * 3], in GRID_M: where it is, or how far it has come since it was told last
 * @property {Int32Array} movedQ  [n * 3]: differences in levels, or the first is the packed rotation
 */

/**
 * @typedef {object} Overlay
 * @property {"overlay"} kind
 * @property {Uint32Array} auraSlots
 * @property {Float32Array} auraRadii
 * @property {Uint32Array} links  [n * 2] slots
 * @property {Uint32Array} contacts  [n * 2] slots
 */

/**
 * @param {ArrayBuffer} buffer
 * @returns {Frame | Overlay | {kind: "refused", why: string}}
 */
export function decode(buffer) {
  if (!(buffer instanceof ArrayBuffer) || buffer.byteLength < 4) return refused("shorter than a header");
  const view = new DataView(buffer);
  const version = view.getUint16(2, true);
  if (version !== VERSION) return refused(`version ${version}, this page reads ${VERSION}`);
  const type = view.getUint8(0);
  if (type === FRAME) return decodeFrame(view);
  if (type === OVERLAY) return decodeOverlay(view);
  return refused(`type ${type} is not known`);
}

function refused(why) {
  return { kind: "refused", why };
}

function decodeFrame(view) {
  if (view.byteLength < FRAME_HEADER) return refused("shorter than a frame's header");
  const [deletedCount, createdCount, hostsCount, movedCount] = [16, 20, 24, 28].map((at) => view.getUint32(at, true));
  const posesAt = FRAME_HEADER + deletedCount * 4 + createdCount * 16 + hostsCount * 12;
  if (view.byteLength < posesAt + movedCount) return refused(`a frame of ${view.byteLength} bytes, its counts say more`);
  const stamp = view.getFloat64(8, true);
  if (!Number.isFinite(stamp)) return refused("the stamp is not finite");

  let at = FRAME_HEADER;
  const deleted = new Uint32Array(deletedCount);
  for (let i = 0; i < deletedCount; ++i, at += 4) deleted[i] = view.getUint32(at, true);
  const created = readCreated(view, at, createdCount);
  at += createdCount * 16;
  const hosts = readHosts(view, at, hostsCount);
  const moved = readMoved(view, posesAt, movedCount);
  if (!created) return refused("a slot beyond the limit");
  if (!moved) return refused("its bytes do not fit to its counts");
  return {
    kind: "frame", key: (view.getUint8(1) & 1) !== 0, generation: view.getUint32(4, true), stamp,
    deletedCount, createdCount, hostsCount, movedCount, deleted, created, hosts, ...moved,
  };
}

function readCreated(view, start, count) {
  const created = new Array(count);
  for (let i = 0, at = start; i < count; ++i, at += 16) {
    const slot = view.getUint32(at, true);
    if (slot >= MAX_SLOTS) return null;
    // Ids are 64 bits wide, but scenes count them from 0: a double holds them.
    const id = view.getUint32(at + 8, true) + view.getUint32(at + 12, true) * 2 ** 32;
    created[i] = { slot, prototype: view.getUint32(at + 4, true), id };
  }
  return created;
}

function readHosts(view, start, count) {
  const hosts = new Array(count);
  for (let i = 0, at = start; i < count; ++i, at += 12) {
    hosts[i] = {
      slot: view.getUint32(at, true), host: view.getUint16(at + 4, true), flags: view.getUint16(at + 6, true),
      epoch: view.getUint32(at + 8, true),
    };
  }
  return hosts;
}

const POSITION_BYTES = [0, 3, 6, 18];
const ROTATION_BYTES = [0, 3, 4];

/** @returns null if it does not end where the message ends */
function readMoved(view, start, count) {
  const movedSlots = new Uint32Array(count);
  const movedHow = new Uint8Array(count);
  const movedP = new Float64Array(count * 3);
  const movedQ = new Int32Array(count * 3);
  let at = start;
  for (let i = 0, next = 0; i < count; ++i) {
    if (at >= view.byteLength) return null;
    const head = view.getUint8(at++);
    const [position, rotation, passed] = [head & 3, (head >> 2) & 3, head >> 4];
    const size = (passed === FAR_SLOT ? 4 : 0) + POSITION_BYTES[position] + ROTATION_BYTES[rotation];
    if (!(at + size <= view.byteLength)) return null;
    const slot = passed === FAR_SLOT ? view.getUint32(at, true) : next + passed;
    if (passed === FAR_SLOT) at += 4;
    next = slot + 1;
    movedSlots[i] = slot;
    movedHow[i] = head & 15;
    readPosition(view, at, position, movedP, 3 * i);
    at += POSITION_BYTES[position];
    if (rotation === WHOLE_ROTATION) movedQ[3 * i] = view.getInt32(at, true);
    else if (rotation === BYTE_LEVELS) for (let k = 0; k < 3; ++k) movedQ[3 * i + k] = view.getInt8(at + k);
    at += ROTATION_BYTES[rotation];
  }
  return at === view.byteLength ? { movedSlots, movedHow, movedP, movedQ } : null;
}

function readPosition(view, start, how, out, to) {
  for (let axis = 0, at = start; axis < 3; ++axis) {
    if (how === BYTE_STEPS) out[to + axis] = view.getInt8(at + axis);
    else if (how === WORD_STEPS) out[to + axis] = view.getInt16(at + 2 * axis, true);
    else if (how === WHOLE_POSITION) out[to + axis] = view.getUint32(at + 6 * axis, true) + view.getInt16(at + 6 * axis + 4, true) * 2 ** 32;
  }
}

/** A packed rotation whose levels have changed by so much. */
export function turnPacked(packed, levels, at = 0) {
  const part = (shift, difference) => ((((packed >>> shift) & 1023) + difference) & 1023) << shift;
  return ((packed & 0xc0000000) | part(20, levels[at]) | part(10, levels[at + 1]) | part(0, levels[at + 2])) >>> 0;
}

/**
 * Smallest three: the largest component is left out, and is what makes the length 1.
 * @param {number} packed
 * @param {Float32Array | number[]} out  w x y z from `at`
 * @param {number} at
 */
export function unpackRotation(packed, out, at = 0) {
  const largest = packed >>> 30;
  let shift = 20;
  let rest = 1;
  for (let i = 0; i < 4; ++i) {
    if (i === largest) continue;
    const c = ((((packed >>> shift) & 1023) / 1023) * 2 - 1) * Math.SQRT1_2;
    out[at + i] = c;
    rest -= c * c;
    shift -= 10;
  }
  out[at + largest] = Math.sqrt(Math.max(0, rest));
}

/**
 * The other direction, for the mock overseer and the tests.
 * @param {ArrayLike<number>} q  w x y z
 */
export function packRotation(q) {
  let largest = 0;
  for (let i = 1; i < 4; ++i) if (Math.abs(q[i]) > Math.abs(q[largest])) largest = i;
  const sign = q[largest] < 0 ? -1 : 1;
  let packed = largest;
  for (let i = 0; i < 4; ++i) {
    if (i === largest) continue;
    const level = Math.round(((sign * q[i] * Math.SQRT2 + 1) / 2) * 1023);
    packed = packed * 1024 + Math.min(1023, Math.max(0, level));
  }
  return packed;
}

function decodeOverlay(view) {
  if (view.byteLength < OVERLAY_HEADER) return refused("shorter than an overlay's header");
  const [auras, links, contacts] = [4, 8, 12].map((at) => view.getUint32(at, true));
  const expected = OVERLAY_HEADER + (auras + links + contacts) * 8;
  if (view.byteLength !== expected) return refused(`overlays of ${view.byteLength} bytes, their counts say ${expected}`);
  let at = OVERLAY_HEADER;
  const auraSlots = new Uint32Array(auras);
  const auraRadii = new Float32Array(auras);
  for (let i = 0; i < auras; ++i, at += 8) {
    auraSlots[i] = view.getUint32(at, true);
    auraRadii[i] = view.getFloat32(at + 4, true);
  }
  const pairs = (count) => {
    const out = new Uint32Array(count * 2);
    for (let i = 0; i < count * 2; ++i, at += 4) out[i] = view.getUint32(at, true);
    return out;
  };
  return { kind: "overlay", auraSlots, auraRadii, links: pairs(links), contacts: pairs(contacts) };
}
