import { expect, test } from "vitest";
import { decode } from "../../src/overseer/web/src/frames.js";
import { World } from "../../src/overseer/web/src/world.js";
import { writeFrame } from "./frame_writer.mjs";

const apply = (world, frame) => world.apply(decode(writeFrame(frame)));
const body = (slot, id, p = [0, 0, 0], host = 0) => ({ created: [{ slot, id }], hosts: [{ slot, host }], moved: [{ slot, p }] });
const at = (world, slot, stamp) => {
  const out = { p: [0, 0, 0], q: [0, 0, 0, 0] };
  return world.sample(slot, stamp, out) ? out : null;
};
const ids = (world) => [...world.slots()].map((slot) => world.id[slot]);

test("ACreatedBodyIsThereAndADeletedOneIsNot", () => {
  const world = new World();
  apply(world, { key: true, stamp: 0, ...body(3, 30, [1, 2, 3], 2) });
  expect(ids(world)).toEqual([30]);
  expect(world.position(3)).toEqual([1, 2, 3]);
  expect(world.host[3]).toBe(2);
  apply(world, { stamp: 1, deleted: [3] });
  expect(world.size).toBe(0);
  expect(at(world, 3, 1)).toBe(null);
});

test("ASlotIsGivenOutAgainWithNothingLeftOfItsFormerBody", () => {
  const world = new World();
  apply(world, { key: true, stamp: 0, ...body(0, 1, [100, 0, 0], 3) });
  apply(world, { stamp: 1, moved: [{ slot: 0, p: [101, 0, 0] }] });
  const change = apply(world, { stamp: 2, deleted: [0], ...body(0, 2, [5, 0, 0], 1) });
  expect(change).toMatchObject({ removed: [0], added: [0] });
  expect(ids(world)).toEqual([2]);
  expect(at(world, 0, 1.5).p).toEqual([5, 0, 0]);
  expect(world.slotOfId.has(1)).toBe(false);
});

test("AKeyFrameForgetsEveryBodyFirst", () => {
  const world = new World();
  apply(world, { key: true, stamp: 0, ...body(0, 1) });
  apply(world, { key: true, stamp: 9, ...body(1, 7) });
  expect(ids(world)).toEqual([7]);
});

test("AnotherGenerationForgetsEveryBodyFirst", () => {
  const world = new World();
  apply(world, { key: true, generation: 1, stamp: 0, ...body(0, 1) });
  expect(apply(world, { generation: 2, stamp: 0, ...body(1, 7) }).cleared).toBe(true);
  expect(ids(world)).toEqual([7]);
});

test("AnIdIsNeverInTwoSlotsAndADuplicateIsCounted", () => {
  const world = new World();
  apply(world, { key: true, stamp: 0, ...body(0, 1) });
  apply(world, { stamp: 1, ...body(5, 1) });
  expect([...world.slots()]).toEqual([5]);
  expect(world.counts.duplicates).toBe(1);
});

test("ABodyKeepsItsSlotAndIdThroughAHandOff", () => {
  const world = new World();
  apply(world, { key: true, stamp: 0, ...body(0, 1, [0, 0, 0], 0) });
  const change = apply(world, { stamp: 1, hosts: [{ slot: 0, host: 1, flags: 4, epoch: 1 }] });
  expect(change.handedOver).toEqual([0]);
  expect([world.size, world.host[0], world.epoch[0], world.counts.handOffs]).toEqual([1, 1, 1, 1]);
});

test("WordsAboutUnknownSlotsAreIgnoredAndCounted", () => {
  const world = new World();
  apply(world, { key: true, stamp: 0, deleted: [9], hosts: [{ slot: 8, host: 1 }], moved: [{ slot: 100000, p: [0, 0, 0] }] });
  expect(world.size).toBe(0);
  expect(world.counts.ignored).toBe(3);
});

test("TheTableGrowsAndKeepsWhatItHas", () => {
  const world = new World(2);
  apply(world, { key: true, stamp: 0, ...body(0, 1, [4, 5, 6]) });
  apply(world, { stamp: 1, ...body(5000, 2, [7, 8, 9]) });
  expect(world.position(0)).toEqual([4, 5, 6]);
  expect(world.position(5000)).toEqual([7, 8, 9]);
});

test("BetweenTwoStatesABodyIsBetweenThem", () => {
  const world = new World();
  apply(world, { key: true, stamp: 10, ...body(0, 1, [0, 0, 0]) });
  apply(world, { stamp: 13, moved: [{ slot: 0, p: [3, 0, 6], q: [Math.SQRT1_2, 0, 0, Math.SQRT1_2] }] });
  const middle = at(world, 0, 11);
  expect(middle.p[0]).toBeCloseTo(1);
  expect(middle.p[2]).toBeCloseTo(2);
  expect(2 * Math.acos(middle.q[0])).toBeCloseTo(Math.PI / 6, 2);
  expect(at(world, 0, 5).p).toEqual([0, 0, 0]);
  expect(at(world, 0, 99).p).toEqual([3, 0, 6]);
});

test("ABodyThatWakesDoesNotSeemToHaveDriftedWhileItSlept", () => {
  const world = new World();
  apply(world, { key: true, stamp: 0, ...body(0, 1, [0, 0, 0]) });
  for (let stamp = 3; stamp <= 300; stamp += 3) apply(world, { stamp });
  apply(world, { stamp: 303, moved: [{ slot: 0, p: [3, 0, 0] }] });
  expect(at(world, 0, 300).p[0]).toBeCloseTo(0);
  expect(at(world, 0, 302).p[0]).toBeCloseTo(2);
});

test("TimeThatGoesBackLeavesNoFuture", () => {
  const world = new World();
  apply(world, { key: true, stamp: 100, ...body(0, 1, [50, 0, 0]) });
  apply(world, { key: true, stamp: 10, ...body(0, 1, [1, 0, 0]) });
  expect(at(world, 0, 50).p).toEqual([1, 0, 0]);
});

test("VelocityIsTheDifferenceOfTheLastTwoStates", () => {
  const world = new World();
  apply(world, { key: true, stamp: 0, ...body(0, 1, [0, 0, 0]) });
  apply(world, { stamp: 3, moved: [{ slot: 0, p: [6, 0, -3] }] });
  const v = [0, 0, 0];
  expect(world.velocity(0, v)).toBe(true);
  expect(v).toEqual([2, 0, -1]);
  apply(world, { stamp: 6 });
  expect(world.velocity(0, v)).toBe(false); // it did not move
});
