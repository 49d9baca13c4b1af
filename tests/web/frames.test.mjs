import { expect, test } from "vitest";
import { GRID_M, decode, packRotation, turnPacked, unpackRotation } from "../../src/overseer/web/src/frames.js";
import { writeFrame, writeOverlay } from "./frame_writer.mjs";

const whole = () => writeFrame({ key: true, generation: 3, stamp: 120, deleted: [7, 9],
  created: [{ slot: 4, prototype: 2, id: 2 ** 32 + 5 }], hosts: [{ slot: 4, host: 3, flags: 5, epoch: 11 }],
  moved: [{ slot: 4, p: [1001.5, -1999, 2.5], q: [0, 0, 1, 0] }] });

test("EveryFieldOfAFrameIsRead", () => {
  const frame = decode(whole());
  expect(frame).toMatchObject({ kind: "frame", key: true, generation: 3, stamp: 120 });
  expect([...frame.deleted]).toEqual([7, 9]);
  expect(frame.created).toEqual([{ slot: 4, prototype: 2, id: 2 ** 32 + 5 }]);
  expect(frame.hosts).toEqual([{ slot: 4, host: 3, flags: 5, epoch: 11 }]);
  expect([...frame.movedSlots]).toEqual([4]);
  expect([...frame.movedP].map((steps) => steps * GRID_M)).toEqual([1001.5, -1999, 2.5]);
});

test("AnEmptyFrameIsAFrame", () => {
  expect(decode(writeFrame({ stamp: 5 }))).toMatchObject({ kind: "frame", key: false, stamp: 5, movedCount: 0 });
});

test("ARotationSurvivesPackingInEveryLargestComponentAndSign", () => {
  const s = Math.SQRT1_2;
  const rotations = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1], [s, s, 0, 0], [s, 0, -s, 0], [-0.5, 0.5, 0.5, -0.5],
    [0.1, -0.2, 0.3, -Math.sqrt(1 - 0.14)]];
  for (const q of rotations) {
    const out = [0, 0, 0, 0];
    unpackRotation(packRotation(q), out);
    const cosine = Math.abs(out.reduce((sum, c, i) => sum + c * q[i], 0));
    expect(2 * Math.acos(Math.min(1, cosine))).toBeLessThan(0.004); // rad
    expect(Math.hypot(...out)).toBeCloseTo(1, 6);
  }
});

test("ThePackedBitsAreThoseOfTheContract", () => {
  // w is the largest: index 0 in the top bits, then x, y, z; 0 is level 511.5, rounded up.
  expect(packRotation([1, 0, 0, 0])).toBe(512 * 2 ** 20 + 512 * 2 ** 10 + 512);
  expect(packRotation([0, 0, 0, -1]) >>> 30).toBe(3);
});

test("OverlaysAreRead", () => {
  const overlay = decode(writeOverlay({ auras: [[1, 2.5]], links: [[3, 4], [5, 6]], contacts: [[7, 8]] }));
  expect(overlay.kind).toBe("overlay");
  expect([...overlay.auraSlots, ...overlay.auraRadii, ...overlay.links, ...overlay.contacts]).toEqual([1, 2.5, 3, 4, 5, 6, 7, 8]);
});

test("EveryTruncationIsRefusedWithoutThrowing", () => {
  const bytes = whole();
  for (let length = 0; length < bytes.byteLength; ++length) expect(decode(bytes.slice(0, length)).kind).toBe("refused");
  const overlay = writeOverlay({ links: [[1, 2]] });
  for (let length = 0; length < overlay.byteLength; ++length) expect(decode(overlay.slice(0, length)).kind).toBe("refused");
});

test("BytesTooManyAreRefused", () => {
  const longer = new Uint8Array(whole().byteLength + 4);
  longer.set(new Uint8Array(whole()));
  expect(decode(longer.buffer).kind).toBe("refused");
});

test("NonsenseIsRefusedWithAReason", () => {
  const spoilt = (change) => {
    const buffer = whole();
    change(new DataView(buffer));
    return decode(buffer);
  };
  expect(spoilt((v) => v.setUint16(2, 9, true)).why).toMatch(/version/);
  expect(spoilt((v) => v.setUint8(0, 77)).why).toMatch(/type/);
  expect(spoilt((v) => v.setFloat64(8, NaN, true)).kind).toBe("refused");
  expect(spoilt((v) => v.setUint32(28, 0xffffffff, true)).kind).toBe("refused");
  expect(spoilt((v) => v.setUint32(40, 0xffffffff, true)).why).toMatch(/slot/); // created
  expect(spoilt((v) => v.setUint8(32 + 8 + 16 + 12, 15)).kind).toBe("refused"); // no such way to tell a rotation
  expect(decode("text").kind).toBe("refused");
});

test("RandomBytesNeverThrow", () => {
  let state = 12345;
  const random = () => (state = (Math.imul(state, 1103515245) + 12345) >>> 0) >>> 8;
  for (let i = 0; i < 3000; ++i) {
    const bytes = new Uint8Array(random() % 200).map(random);
    if (bytes.length > 3) bytes.set([1 + (random() % 2), random() % 2, 2, 0]);
    expect(["refused", "frame", "overlay"]).toContain(decode(bytes.buffer).kind);
  }
});

test("DifferencesAreReadFromAsManyBytesAsTheirHeadSays", () => {
  const view = new DataView(new ArrayBuffer(32 + 7 + 11));
  [[0, 1], [2, 2]].forEach(([at, value]) => view.setUint8(at, value));
  view.setUint32(28, 2, true);
  // Slot 3 by three bytes, and its rotation by three; slot 300 by three words.
  [1 | (1 << 2) | (3 << 4), 0xff, 2, 0, 1, 0xfe, 0].forEach((byte, i) => view.setUint8(32 + i, byte));
  view.setUint8(39, 2 | (15 << 4));
  view.setUint32(40, 300, true);
  [-300, 0, 4000].forEach((steps, i) => view.setInt16(44 + 2 * i, steps, true));
  const frame = decode(view.buffer);
  expect([...frame.movedSlots]).toEqual([3, 300]);
  expect([...frame.movedP]).toEqual([-1, 2, 0, -300, 0, 4000]);
  expect([...frame.movedQ.slice(0, 3)]).toEqual([1, -2, 0]);
});

test("APackedRotationIsTurnedByItsLevels", () => {
  const packed = packRotation([0.1, -0.2, 0.3, -Math.sqrt(1 - 0.14)]);
  const turned = turnPacked(packed, [3, -4, 5]);
  expect(turned >>> 30).toBe(3);
  expect([20, 10, 0].map((shift) => ((turned >>> shift) & 1023) - ((packed >>> shift) & 1023))).toEqual([3, -4, 5]);
});
