import { beforeEach, expect, test } from "vitest";
import { ViewTeller } from "../../src/overseer/web/src/view_teller.js";

const EYE = { eye: [0, 0, 10], towards: [1, 0, 0], half_angle: 0.6, pixel: 0.001 };
let told, teller;
beforeEach(() => {
  told = [];
  teller = new ViewTeller((message) => told.push(message) > 0);
});

test("AnEyeThatStandsStillIsToldOnce", () => {
  for (let now_ms = 0; now_ms < 5000; now_ms += 16) teller.look(EYE, now_ms);
  expect(told).toEqual([{ type: "view", ...EYE }]);
});

test("AnEyeThatMovesIsToldTenTimesASecond", () => {
  for (let now_ms = 0; now_ms < 2000; now_ms += 16) teller.look({ ...EYE, eye: [now_ms / 100, 0, 10] }, now_ms);
  expect(told.length).toBeGreaterThan(14);
  expect(told.length).toBeLessThan(21);
});

test("TheViewFromAboveAsksForEverything", () => {
  teller.look(EYE, 0);
  teller.look({}, 200);
  expect(told.at(-1)).toEqual({ type: "view" });
});

test("APageThatIsLookedAtAgainTellsItsViewAtOnce", () => {
  teller.look(EYE, 0);
  teller.hide();
  expect(told.at(-1)).toEqual({ type: "view", hidden: true });
  teller.look(EYE, 1);
  expect(told.at(-1)).toEqual({ type: "view", ...EYE });
});

test("WhatCouldNotBeSentIsSentLater", () => {
  let open = false;
  const waiting = new ViewTeller(() => open);
  waiting.look(EYE, 0);
  open = true;
  waiting.look(EYE, 1);
  expect(waiting.told).toEqual(EYE);
});
