import { expect, test } from "vitest";
import { Quality } from "../../src/overseer/web/src/quality.js";

const draw = (quality, frame_ms, seconds) => {
  for (let t = 0; t < seconds * 1000; t += frame_ms) quality.frame(frame_ms);
};

test("SlowFramesLowerTheLevelAndItStaysThere", () => {
  const quality = new Quality(5);
  draw(quality, 40, 5);
  const level = quality.level;
  expect(level).toBeLessThan(5);
  draw(quality, 16, 120);
  expect(quality.level).toBeLessThan(5);
});

test("FastFramesRaiseItSlowly", () => {
  const quality = new Quality(3);
  draw(quality, 16, 5);
  expect(quality.level).toBe(3);
  draw(quality, 16, 60);
  expect(quality.level).toBe(6);
});

test("AHiddenTabSaysNothing", () => {
  const quality = new Quality(5);
  for (let i = 0; i < 10; ++i) quality.frame(5000);
  expect(quality.level).toBe(5);
});

test("APinnedLevelIsKept", () => {
  const quality = new Quality(5, 6);
  draw(quality, 200, 20);
  expect(quality.current.name).toBe("best");
});
