import { expect, test } from "vitest";
import { StampClock } from "../../src/overseer/web/src/clock.js";

const STEPS_PER_MS = 0.06;

/** Frames of 3 steps every 50 ms, late by up to `jitter` ms, drawn every 16 ms. */
function run({ ms = 4000, rate = 1, jitter = 0, clock = new StampClock(), from_ms = 0, stamp = 0 }) {
  clock.expect(STEPS_PER_MS, 3);
  const shown = [];
  let next_ms = from_ms;
  for (let now_ms = from_ms; now_ms < from_ms + ms; now_ms += 16) {
    while (next_ms <= now_ms) {
      stamp += 3;
      clock.arrive(stamp, now_ms);
      next_ms += 50 / rate + (((stamp / 3) % 3) - 1) * jitter;
    }
    shown.push(clock.tick(now_ms));
  }
  return { clock, shown, stamp, end_ms: from_ms + ms };
}

const paces = (shown) => shown.slice(1).map((x, i) => (x - shown[i]) / 16);

test("ThePlayheadRunsEvenlyAndAboutOneAndAHalfFramesBehind", () => {
  const { clock, shown } = run({});
  for (const pace of paces(shown.slice(100))) expect(Math.abs(pace / STEPS_PER_MS - 1)).toBeLessThan(0.15);
  expect(clock.newest - shown.at(-1)).toBeGreaterThan(0.9);
  expect(clock.newest - shown.at(-1)).toBeLessThan(6.5);
});

test("FramesThatComeUnevenlyDoNotMakeItStumble", () => {
  for (const pace of paces(run({ jitter: 20 }).shown.slice(120))) {
    expect(pace).toBeGreaterThan(0.5 * STEPS_PER_MS);
    expect(pace).toBeLessThan(1.6 * STEPS_PER_MS);
  }
});

test("ItNeverRunsBackwardsNorBeyondWhatIsKnown", () => {
  const { shown, clock } = run({ jitter: 30 });
  expect(paces(shown).every((pace) => pace >= 0)).toBe(true);
  expect(shown.at(-1)).toBeLessThanOrEqual(clock.newest);
});

test("SlowMotionIsFollowed", () => {
  const shown = run({ rate: 0.25, ms: 12000 }).shown.slice(400);
  const pace = (shown.at(-1) - shown[0]) / (16 * (shown.length - 1));
  expect(pace / STEPS_PER_MS).toBeCloseTo(0.25, 1);
});

test("InAPauseItComesToTheNewestAndStaysThere", () => {
  const { clock, end_ms, stamp } = run({});
  let shown = 0;
  for (let now_ms = end_ms; now_ms < end_ms + 2000; now_ms += 16) shown = clock.tick(now_ms);
  expect(shown).toBeCloseTo(stamp, 1);
});

test("AfterAPauseItGoesOnWithoutAJump", () => {
  const { clock, end_ms, stamp } = run({});
  for (let now_ms = end_ms; now_ms < end_ms + 3000; now_ms += 16) clock.tick(now_ms);
  const { shown } = run({ clock, from_ms: end_ms + 3000, stamp, ms: 1500 });
  for (const pace of paces(shown)) expect(pace).toBeLessThan(3 * STEPS_PER_MS);
});

test("ASeekIsFollowedAtOnce", () => {
  const { clock, end_ms } = run({});
  clock.arrive(2000, end_ms);
  clock.tick(end_ms);
  expect(clock.tick(end_ms + 16)).toBeGreaterThan(1900);
  clock.arrive(50, end_ms + 32);
  expect(clock.tick(end_ms + 48)).toBeLessThanOrEqual(50);
});
