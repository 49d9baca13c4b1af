// Lowers the effort of drawing when frames take too long, and raises it again, once, when they do not. Pure.

/** From what any machine can do to what looks best. `pixels`: highest ratio of drawn to displayed pixels. */
export const LEVELS = [
  { name: "crude", detail: 0, shadows: 0, pixels: 0.5 },
  { name: "minimal", detail: 1, shadows: 0, pixels: 0.5 },
  { name: "low", detail: 1, shadows: 0, pixels: 0.75 },
  { name: "plain", detail: 1, shadows: 0, pixels: 1 },
  { name: "medium", detail: 2, shadows: 1024, pixels: 1 },
  { name: "high", detail: 2, shadows: 2048, pixels: 1.5 },
  { name: "best", detail: 3, shadows: 2048, pixels: 2 },
];

const WINDOW_MS = 1000;
const SLOW_MS = 23; // below 43 frames a second
const MUCH_TOO_SLOW_MS = 90;
const FAST_MS = 17.6;
const CALM_WINDOWS = 12;

export class Quality {
  /** @param {number} level  where to start  @param {number | null} pinned  a level to stay at */
  constructor(level, pinned = null) {
    this.level = level;
    this.ceiling = LEVELS.length - 1;
    this.pinned = pinned;
    this.#begin();
    this.slow = this.fast = 0;
    this.frame_ms = 0;
  }

  #begin() {
    this.total_ms = 0;
    this.frames = 0;
  }

  get current() {
    return LEVELS[this.pinned ?? this.level];
  }

  /** Time between two frames. @returns {boolean} has the level changed? */
  frame(dt_ms) {
    if (dt_ms > 1500) return false; // the tab was hidden: says nothing
    this.total_ms += dt_ms;
    ++this.frames;
    if (this.total_ms < WINDOW_MS) return false;
    this.frame_ms = this.total_ms / this.frames;
    this.#begin();
    if (this.pinned !== null) return false;
    this.slow = this.frame_ms > SLOW_MS ? this.slow + 1 : 0;
    this.fast = this.frame_ms < FAST_MS ? this.fast + 1 : 0;
    if (this.frame_ms > MUCH_TOO_SLOW_MS && this.level > 1) return this.#step(-2);
    if (this.slow >= 2 && this.level > 0) return this.#step(-1);
    if (this.fast >= CALM_WINDOWS && this.level < this.ceiling) return this.#step(1);
    return false;
  }

  #step(by) {
    // A level that was too slow is not tried again: no flickering to and fro.
    if (by < 0) this.ceiling = this.level - 1;
    this.level += by;
    this.slow = this.fast = 0;
    return true;
  }
}
