import { expect, test } from "vitest";
import { placeOfStatic, placeOnPath, takeMoves } from "../../src/overseer/web/src/paths.js";

const positionOf = (path, t_s) => placeOnPath(path, t_s).elements.slice(12, 15);
const up = (at, z) => ({ at, p: [0, 0, z], q: [1, 0, 0, 0] });

test("a lift goes from stop to stop, and stays at the last", () => {
  const path = { stops: [up(2, 3), up(3, 3), up(5, 1)], repeats: false, smooth: false };
  expect(positionOf(path, 0)).toEqual([0, 0, 0]);
  expect(positionOf(path, 1)[2]).toBeCloseTo(1.5, 12);
  expect(positionOf(path, 2.5)[2]).toBe(3);
  expect(positionOf(path, 4)[2]).toBeCloseTo(2, 12);
  expect(positionOf(path, 100)[2]).toBe(1);
});

test("a smooth one rests at its stops", () => {
  const path = { stops: [up(2, 3)], repeats: false, smooth: true };
  expect(positionOf(path, 0.5)[2]).toBeCloseTo(3 * 0.15625, 12);
  expect(positionOf(path, 1)[2]).toBeCloseTo(1.5, 12);
});

test("one that repeats begins again, and turns on the shorter way", () => {
  const turned = (at, deg) => ({ at, p: [0, 0, 0], q: [Math.cos((deg * Math.PI) / 360), 0, 0, Math.sin((deg * Math.PI) / 360)] });
  const path = { stops: [turned(1, 120), turned(2, -120), turned(3, 0)], repeats: true, smooth: false };
  const angle = (t_s) => (Math.atan2(placeOnPath(path, t_s).elements[1], placeOnPath(path, t_s).elements[0]) * 180) / Math.PI;
  expect(angle(0.5)).toBeCloseTo(60, 9);
  expect(Math.abs(angle(1.5))).toBeCloseTo(180, 9);
  expect(angle(2.5)).toBeCloseTo(-60, 9);
  expect(angle(3.5)).toBeCloseTo(60, 9);
});

test("one that is told to move leaves its path, and stays where it was sent", () => {
  const there = { p: [0, 0, 2], q: [1, 0, 0, 0] }, away = { p: [5, 0, 2], q: [1, 0, 0, 0] };
  const body = { p: [0, 0, 1], q: [1, 0, 0, 0], path: { stops: [up(2, 2)], repeats: false, smooth: false },
    moves: [{ step: 61, states: 10, from: there, to: away }, { step: 101, states: 1, from: away, to: there }] };
  const x = (stamp) => placeOfStatic(body, stamp, 1 / 60).elements.slice(12, 15);
  expect(x(60)).toEqual([0, 0, 2]);
  expect(x(65)[0]).toBeCloseTo(2.5, 12);
  expect(x(70)).toEqual([5, 0, 2]);
  expect(x(99)).toEqual([5, 0, 2]);
  expect(x(101)).toEqual([0, 0, 2]);
  expect(x(30)[2]).toBeCloseTo(1.5, 12);
});

test("moves go to their statics, in the world that they are of", () => {
  const scene = { generation: 2, statics: [{ id: 0 }, { id: 3 }, { id: 4, moves: ["old"] }] };
  expect(takeMoves(scene, { generation: 1, statics: [{ id: 3, moves: ["of another world"] }] })).toBe(false);
  expect(takeMoves(scene, { generation: 2, statics: [{ id: 3, moves: ["away"] }, { id: 9, moves: [] }] })).toBe(true);
  expect(scene.statics).toEqual([{ id: 0 }, { id: 3, moves: ["away"] }, { id: 4, moves: ["old"] }]);
});
