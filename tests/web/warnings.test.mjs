import { expect, test } from "vitest";
import { WARNINGS, lateOf, sumOf, warningsOf } from "../../src/overseer/web/src/warnings.js";

const node = (violations, late = 0, missed = 0) => ({ violations, late, missed });

test("EveryKindOfTheStatusHasWords", () => {
  expect(Object.keys(WARNINGS)).toEqual(["speed", "latency", "frame", "promise", "span"]);
  for (const [name, means] of Object.values(WARNINGS)) expect(name.length * means.length).toBeGreaterThan(0);
});

test("OnlyWhatHappenedIsShown", () => {
  expect(warningsOf(node({ speed: 0, frame: 3 }))).toEqual([{ name: "slow frame", means: WARNINGS.frame[1], count: 3 }]);
});

test("WarningsAreNotLate", () => {
  expect(sumOf([node({ frame: 3, speed: 1 }), node({ promise: 2 })])).toEqual({ warnings: 6, late: 0 });
  expect(sumOf([node({}, 2, 1), node({}, 1)])).toEqual({ warnings: 0, late: 4 });
});

test("WhoDoesNotCountThemDoesNotSayThatThereAreNone", () => {
  expect(lateOf({ violations: { speed: 1 } })).toBe(0);
  expect(sumOf([{}])).toEqual({ warnings: 0, late: NaN });
});
