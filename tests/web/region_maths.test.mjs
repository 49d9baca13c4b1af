import { expect, test } from "vitest";
import * as maths from "../../src/overseer/web/src/region_maths.js";

const inf = Infinity;
const GRID = [[-inf, -inf, 0, 0], [0, -inf, inf, 0], [-inf, 0, 0, inf], [0, 0, inf, inf]];

test("TheWireHasNullForInfinity", () => {
  const boxes = maths.boxesOfMap([{ id: 1, x0: 0, y0: null, x1: null, y1: null }, { id: 0, x0: null, y0: null, x1: 0, y1: null }]);
  expect(boxes).toEqual([[-inf, -inf, 0, inf], [0, -inf, inf, inf]]);
  expect(maths.boxesForWire(boxes)).toEqual([[null, null, 0, null], [0, null, null, null]]);
});

test("AGridOfFourHasFourBorders", () => {
  const borders = maths.bordersOf(GRID);
  expect(borders).toHaveLength(4);
  expect(borders.filter((b) => b.axis === 0).map((b) => [b.below, b.above])).toEqual([[[0], [1]], [[2], [3]]]);
});

test("AMovedBorderMovesOnlyItsOwnRegionsAndLeavesNoGap", () => {
  const [south] = maths.bordersOf(GRID);
  const moved = maths.moveBorder(GRID, south, 7);
  expect([moved[0][2], moved[1][0], moved[2][2], moved[3][0]]).toEqual([7, 7, 0, 0]);
  expect(maths.dividesThePlane(moved)).toBe(true);
});

test("AWholeLineMovesTogether", () => {
  const line = maths.wholeLine(GRID, maths.bordersOf(GRID)[0]);
  const moved = maths.moveBorder(GRID, line, -3);
  expect(moved.map((b) => [b[0], b[2]])).toEqual([[-inf, -3], [-3, inf], [-inf, -3], [-3, inf]]);
  expect(maths.dividesThePlane(moved)).toBe(true);
});

test("ABorderStopsBeforeARegionVanishes", () => {
  const columns = maths.pattern("columns", 3, [-15, -15, 15, 15]);
  const [first] = maths.bordersOf(columns);
  expect(maths.moveBorder(columns, first, 100)[0][2]).toBe(5 - maths.MIN_WIDTH);
});

test("WhereRegionsOverlapAlongALineItMovesAsOne", () => {
  const brick = maths.pattern("brick", 4, [-20, -20, 20, 20]);
  expect(maths.dividesThePlane(brick)).toBe(true);
  const horizontal = maths.bordersOf(brick).filter((b) => b.axis === 1);
  expect(horizontal).toHaveLength(1);
  expect(maths.dividesThePlane(maths.moveBorder(brick, horizontal[0], 6))).toBe(true);
});

test("EveryPatternOfEveryCountDividesThePlane", () => {
  for (const kind of ["columns", "grid", "brick"]) {
    for (let count = 1; count <= 16; ++count) {
      const boxes = maths.pattern(kind, count, [-30, -10, 30, 50]);
      expect(boxes).toHaveLength(count);
      expect(maths.dividesThePlane(boxes), `${kind} of ${count}`).toBe(true);
    }
  }
});

test("CuttingAndJoiningUndoEachOther", () => {
  const cut = maths.cutRegion(GRID, 3, 1, 12);
  expect(cut).toHaveLength(5);
  expect(maths.dividesThePlane(cut)).toBe(true);
  const border = maths.bordersOf(cut).find((b) => b.at === 12);
  expect(maths.joinAcross(cut, border)).toEqual(GRID);
});

test("ABorderWithMoreThanTwoRegionsIsNotTakenAway", () => {
  const cut = maths.cutRegion(GRID, 3, 1, 12);
  const line = maths.wholeLine(cut, maths.bordersOf(cut).find((b) => b.axis === 0 && b.to === inf));
  expect(maths.joinAcross(cut, line)).toBe(cut);
});

test("OverlapsAndGapsAreFound", () => {
  expect(maths.dividesThePlane([[-inf, -inf, 1, inf], [0, -inf, inf, inf]])).toBe(false);
  expect(maths.dividesThePlane([[-inf, -inf, 0, inf], [1, -inf, inf, inf]])).toBe(false);
  expect(maths.dividesThePlane([[-inf, -inf, inf, inf]])).toBe(true);
});

test("ThePointOnABorderBelongsToTheUpperRegion", () => {
  expect(maths.regionAt(GRID, 0, 0)).toBe(3);
  expect(maths.regionAt(GRID, -0.1, 0)).toBe(2);
});
