// Maps stamps of the simulation to the wall clock, so that bodies move evenly although frames come unevenly, in slow
// motion and through pauses. Pure: the wall clock is passed in.

/** How many frame intervals the picture is behind the newest stamp: enough for one frame that comes late. */
const DELAY_INTERVALS = 1.5;
/** A gap this long (ms) says nothing about the speed: the run was paused, or the tab hidden. */
const GAP_MS = 700;
/** Further away than this many intervals the playhead jumps. */
const JUMP_INTERVALS = 12;

export class StampClock {
  constructor() {
    this.reset();
  }

  reset() {
    this.newest = NaN;
    this.newestAt_ms = 0;
    this.interval = NaN; // steps between frames
    this.speed = NaN; // steps per ms
    this.playhead = NaN;
    this.lastTick_ms = NaN;
  }

  /** What the run is said to do, before frames have shown it. @param {number} stepsPerMs */
  expect(stepsPerMs, interval) {
    if (Number.isNaN(this.speed)) this.speed = stepsPerMs;
    if (Number.isNaN(this.interval)) this.interval = interval;
  }

  /** A frame has come. */
  arrive(stamp, now_ms) {
    const steps = stamp - this.newest;
    const gap_ms = now_ms - this.newestAt_ms;
    if (!(steps >= 0) || steps > JUMP_INTERVALS * Math.max(1, this.interval)) {
      // The first one, or time was moved: a seek, a reset. It says nothing about the speed.
      this.newest = stamp;
      this.newestAt_ms = now_ms;
      this.playhead = stamp;
      return;
    }
    if (steps === 0) return;
    if (gap_ms < GAP_MS) {
      this.interval = blend(this.interval, steps, 0.1);
      // Two frames in one burst would say "infinitely fast": the weight of a measurement is the time it took.
      const weight = Math.min(0.25, gap_ms / 400);
      if (gap_ms > 0) this.speed = blend(this.speed, steps / gap_ms, weight);
    }
    this.newest = stamp;
    this.newestAt_ms = now_ms;
  }

  /** @returns {number} the stamp to show now; never beyond the newest that is known */
  tick(now_ms) {
    if (Number.isNaN(this.newest)) return NaN;
    const dt_ms = Number.isNaN(this.lastTick_ms) ? 0 : Math.max(0, now_ms - this.lastTick_ms);
    this.lastTick_ms = now_ms;
    const interval = this.interval > 0 ? this.interval : 1;
    const speed = this.speed > 0 ? this.speed : 0;
    const age_ms = Math.max(0, now_ms - this.newestAt_ms);
    const target = Math.min(this.newest, this.newest + age_ms * speed - DELAY_INTERVALS * interval);
    const error = target - this.playhead;
    if (Math.abs(error) > JUMP_INTERVALS * interval) {
      this.playhead = target;
    } else {
      // Half of the error is gone after about 150 ms; the playhead never runs backwards.
      const correction = error * (1 - Math.exp(-dt_ms / 220));
      this.playhead += Math.max(0, Math.min(dt_ms * speed, this.newest - this.playhead) + correction);
    }
    this.playhead = Math.min(this.playhead, this.newest);
    return this.playhead;
  }
}

function blend(old, value, weight) {
  return Number.isNaN(old) ? value : old + (value - old) * weight;
}
