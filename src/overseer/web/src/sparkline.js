// The last minute of one value as a tiny chart.

const KEPT = 120; // two values a second would fill a minute; four a second half a minute

export class Sparkline {
  constructor(colour) {
    this.canvas = document.createElement("canvas");
    this.canvas.className = "spark";
    this.canvas.setAttribute("aria-hidden", "true");
    this.colour = colour;
    this.values = [];
    this.limit = NaN;
  }

  /** @param {number} value @param {number} limit  drawn as a dashed line: more than this is too much */
  push(value, limit) {
    this.values.push(Number.isFinite(value) ? value : 0);
    if (this.values.length > KEPT) this.values.shift();
    this.limit = limit;
    this.draw();
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0) return;
    const ratio = window.devicePixelRatio || 1;
    if (this.canvas.width !== Math.round(width * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    const pen = this.canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    const top = Math.max(this.limit * 1.15 || 0, ...this.values) || 1;
    const y = (value) => height - 1.5 - (value / top) * (height - 4);
    const x = (i) => width - ((this.values.length - 1 - i) / (KEPT - 1)) * width;
    this.#limitLine(pen, width, y);
    pen.beginPath();
    this.values.forEach((value, i) => pen.lineTo(x(i), y(value)));
    pen.strokeStyle = this.colour;
    pen.lineWidth = 1.4;
    pen.lineJoin = "round";
    pen.stroke();
    pen.lineTo(x(this.values.length - 1), height);
    pen.lineTo(x(0), height);
    const fill = pen.createLinearGradient(0, 0, 0, height);
    fill.addColorStop(0, `${this.colour}55`);
    fill.addColorStop(1, `${this.colour}00`);
    pen.fillStyle = fill;
    pen.fill();
  }

  #limitLine(pen, width, y) {
    if (!Number.isFinite(this.limit)) return;
    pen.setLineDash([2, 3]);
    pen.strokeStyle = "rgba(255,255,255,.22)";
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(0, y(this.limit));
    pen.lineTo(width, y(this.limit));
    pen.stroke();
    pen.setLineDash([]);
  }
}
