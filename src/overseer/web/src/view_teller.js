// Tells the overseer what the page looks at, so that it sends no more than is seen. Pure: the clock is passed in.

/** Not more often than this, ms. */
const SPACING_MS = 100;
/** The eye has moved: by this much of a radian, or of a metre and of the height of what it sees at 100 m. */
const TURNED = 0.02;
const MOVED_M = 0.2;

const apart = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));

export class ViewTeller {
  /** @param {(message: object) => boolean} send  false if there is nobody */
  constructor(send) {
    this.send = send;
    this.told = null;
    this.told_ms = -Infinity;
  }

  /** A new connection knows nothing. */
  forget() {
    this.told = null;
    this.told_ms = -Infinity;
  }

  /** @param {{eye?: number[], towards?: number[], half_angle?: number, pixel?: number}} eye */
  look(eye, now_ms) {
    if (now_ms - this.told_ms < SPACING_MS || (this.told && !hasChanged(this.told, eye))) return;
    if (this.send({ type: "view", ...eye })) [this.told, this.told_ms] = [eye, now_ms];
  }

  hide() {
    this.forget();
    this.send({ type: "view", hidden: true });
  }
}

function hasChanged(before, now) {
  if (!before.eye || !now.eye) return Boolean(before.eye) !== Boolean(now.eye);
  return apart(before.eye, now.eye) > MOVED_M || apart(before.towards, now.towards) > TURNED
    || Math.abs(before.half_angle - now.half_angle) > TURNED || Math.abs(before.pixel / now.pixel - 1) > 0.1;
}
