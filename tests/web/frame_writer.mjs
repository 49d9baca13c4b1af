// Writes the binary messages of docs/viewer.md: for the mock overseer and for the tests of the reader.
import { GRID_M, packRotation } from "../../src/overseer/web/src/frames.js";

/**
 * @param {{key?: boolean, generation?: number, stamp?: number, deleted?: number[],
 *   created?: {slot: number, prototype?: number, id: number}[],
 *   hosts?: {slot: number, host: number, flags?: number, epoch?: number}[],
 *   moved?: {slot: number, p: number[], q?: number[]}[]}} frame
 * @returns {ArrayBuffer}
 */
export function writeFrame(frame) {
  const { deleted = [], created = [], hosts = [], moved = [] } = frame;
  const view = new DataView(new ArrayBuffer(32 + deleted.length * 4 + created.length * 16 + hosts.length * 12 + moved.length * 27));
  view.setUint8(0, 1);
  view.setUint8(1, frame.key ? 1 : 0);
  view.setUint16(2, 2, true);
  view.setUint32(4, frame.generation ?? 0, true);
  view.setFloat64(8, frame.stamp ?? 0, true);
  [deleted, created, hosts, moved].forEach((list, i) => view.setUint32(16 + 4 * i, list.length, true));
  let at = 32;
  const u32 = (x) => { view.setUint32(at, x, true); at += 4; };
  for (const slot of deleted) u32(slot);
  for (const { slot, prototype = 0, id } of created) [slot, prototype, id % 2 ** 32, Math.floor(id / 2 ** 32)].forEach(u32);
  for (const { slot, host, flags = 0, epoch = 0 } of hosts) [slot, host + flags * 65536, epoch].forEach(u32);
  for (const { slot, p, q = [1, 0, 0, 0] } of moved) {
    view.setUint8(at++, 3 | (2 << 2) | (15 << 4)); // a whole position, a whole rotation, the slot
    u32(slot);
    for (const x of p) {
      const steps = Math.round(x / GRID_M);
      u32(steps - Math.floor(steps / 2 ** 32) * 2 ** 32);
      view.setInt16(at, Math.floor(steps / 2 ** 32), true);
      at += 2;
    }
    u32(packRotation(q));
  }
  return view.buffer;
}

/** @param {{auras?: [number, number][], links?: [number, number][], contacts?: [number, number][]}} overlay */
export function writeOverlay({ auras = [], links = [], contacts = [] }) {
  const view = new DataView(new ArrayBuffer(16 + 8 * (auras.length + links.length + contacts.length)));
  view.setUint8(0, 2);
  view.setUint16(2, 2, true);
  [auras, links, contacts].forEach((list, i) => view.setUint32(4 + 4 * i, list.length, true));
  let at = 16;
  for (const [slot, radius] of auras) {
    view.setUint32(at, slot, true);
    view.setFloat32(at + 4, radius, true);
    at += 8;
  }
  for (const [a, b] of [...links, ...contacts]) {
    view.setUint32(at, a, true);
    view.setUint32(at + 4, b, true);
    at += 8;
  }
  return view.buffer;
}
