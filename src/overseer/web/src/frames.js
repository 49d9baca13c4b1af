// Reads the binary messages of the overseer (docs/viewer.md, "Frames"). Pure: bytes in, plain data out.
// What comes over the wire is checked and refused, with a reason; nothing here throws for bad bytes.

const VERSION = 1;
const FRAME = 1;
const OVERLAY = 2;
const FRAME_HEADER = 56;
const OVERLAY_HEADER = 16;

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
 * @property {Float64Array} origin
 * @property {Uint32Array} deleted  slots
 * @property {{slot: number, prototype: number, id: number}[]} created
 * @property {{slot: number, host: number, flags: number, epoch: number}[]} hosts
 * @property {Uint32Array} movedSlots
 * @property {Float64Array} movedP  [n * 3], world frame, origin added
 * @property {Float32Array} movedQ  [n * 4], w x y z
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
  const [deletedCount, createdCount, hostsCount, movedCount] = [40, 44, 48, 52].map((at) => view.getUint32(at, true));
  const expected = FRAME_HEADER + deletedCount * 4 + createdCount * 16 + hostsCount * 12 + movedCount * 20;
  if (view.byteLength !== expected) return refused(`a frame of ${view.byteLength} bytes, its counts say ${expected}`);
  const stamp = view.getFloat64(8, true);
  const origin = Float64Array.of(view.getFloat64(16, true), view.getFloat64(24, true), view.getFloat64(32, true));
  if (!Number.isFinite(stamp) || !origin.every(Number.isFinite)) return refused("stamp or origin is not finite");

  let at = FRAME_HEADER;
  const deleted = new Uint32Array(deletedCount);
  for (let i = 0; i < deletedCount; ++i, at += 4) deleted[i] = view.getUint32(at, true);
  const created = readCreated(view, at, createdCount);
  at += createdCount * 16;
  const hosts = readHosts(view, at, hostsCount);
  at += hostsCount * 12;
  const moved = readMoved(view, at, movedCount, origin);
  if (!created || !hosts || !moved) return refused("a slot beyond the limit, or a position that is not finite");
  return {
    kind: "frame", key: (view.getUint8(1) & 1) !== 0, generation: view.getUint32(4, true), stamp, origin,
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

function readMoved(view, start, count, origin) {
  const movedSlots = new Uint32Array(count);
  const movedP = new Float64Array(count * 3);
  const movedQ = new Float32Array(count * 4);
  for (let i = 0, at = start; i < count; ++i, at += 20) {
    movedSlots[i] = view.getUint32(at, true);
    for (let axis = 0; axis < 3; ++axis) {
      const value = view.getFloat32(at + 4 + 4 * axis, true) + origin[axis];
      if (!Number.isFinite(value)) return null;
      movedP[3 * i + axis] = value;
    }
    unpackRotation(view.getUint32(at + 16, true), movedQ, 4 * i);
  }
  return { movedSlots, movedP, movedQ };
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
