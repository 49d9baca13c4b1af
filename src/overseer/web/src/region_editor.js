// Drawing the regions, from above: borders are dragged, regions cut and joined, patterns laid over a rectangle.
// The maths are in region_maths.js; this is the hand and the picture.
import { colourOfHost } from "./colours.js";
import { h } from "./dom.js";
import * as maths from "./region_maths.js";

const GRAB_PIXELS = 9;
const SNAP = 0.5; // m

export class RegionEditor {
  /**
   * @param {{rig: import("./camera.js").CameraRig, origin: () => number[], nodes: () => number, coupled: () => boolean,
   *   apply: (boxes: (number | null)[][]) => Promise<{ok: boolean}>, onclose: () => void}} app
   */
  constructor(app) {
    this.app = app;
    this.canvas = document.getElementById("plan");
    this.pen = this.canvas.getContext("2d");
    this.open = false;
    this.#buildBar();
    this.canvas.addEventListener("pointerdown", (event) => this.#down(event));
    this.canvas.addEventListener("pointermove", (event) => this.#move(event));
    this.canvas.addEventListener("pointerup", () => this.#up());
    this.canvas.addEventListener("dblclick", (event) => this.#cut(event));
    this.canvas.addEventListener("contextmenu", (event) => { event.preventDefault(); this.#join(event); });
    this.canvas.addEventListener("wheel", (event) => this.#zoom(event), { passive: false });
  }

  #buildBar() {
    this.count = h("span.count");
    this.applyButton = h("button.primary", { type: "button", id: "regions-apply", onclick: () => this.#apply() }, "Use these regions");
    const preset = (kind, text) => h("button", { type: "button", "data-preset": kind, onclick: () => this.#preset(kind) }, text);
    this.bar = h("div.editor-bar.glass", { hidden: true, role: "toolbar", "aria-label": "Regions" },
      h("strong", {}, "Regions"), preset("columns", "Columns"), preset("grid", "Grid"), preset("brick", "Brick"),
      h("button", { type: "button", onclick: () => this.#restart() }, "As they are"), h("span.rule"), this.count, this.applyButton,
      h("button", { type: "button", onclick: () => this.close() }, "Close"),
      h("p.dim", {}, "Drag a border; with shift, its whole line. Drag over a region to lay the pattern there. Double click cuts, right click on a border joins. Wheel: nearer, farther; middle button: move."));
    document.body.append(this.bar);
  }

  /** @param {{regions: any[]}} map */
  start(map) {
    this.map = map;
    this.kind = "grid";
    this.open = true;
    this.canvas.hidden = this.bar.hidden = false;
    document.body.classList.add("editing");
    this.app.rig.fromAbove = true;
    this.#restart();
    const [x0, y0, x1, y1] = maths.extentOf(this.boxes, 25, 40);
    const [ox, oy] = this.app.origin();
    this.app.rig.topCentre.set((x0 + x1) / 2 - ox, (y0 + y1) / 2 - oy);
    this.app.rig.topHeight = Math.max(y1 - y0, (x1 - x0) / this.app.rig.aspect) * 1.15;
    this.draw();
  }

  close() {
    this.open = false;
    this.canvas.hidden = this.bar.hidden = true;
    document.body.classList.remove("editing");
    this.app.rig.fromAbove = false;
    this.app.onclose();
  }

  #restart() {
    this.boxes = maths.boxesOfMap(this.map.regions);
    this.#changed();
  }

  #preset(kind) {
    this.kind = kind;
    this.bar.querySelectorAll("[data-preset]").forEach((b) => b.setAttribute("aria-pressed", String(b.dataset.preset === kind)));
    const edges = maths.extentOf(this.boxes, 0, 0);
    const size = Math.max(edges[2] - edges[0], edges[3] - edges[1], 10);
    const [x, y] = [(edges[0] + edges[2]) / 2, (edges[1] + edges[3]) / 2];
    this.boxes = maths.pattern(kind, this.#wanted(), [x - size, y - size, x + size, y + size]);
    this.#changed();
  }

  #wanted() {
    return this.app.nodes() || this.map.regions.length;
  }

  #changed() {
    const wanted = this.#wanted();
    const good = this.boxes.length === wanted && maths.dividesThePlane(this.boxes);
    this.count.textContent = `${this.boxes.length} of ${wanted}`;
    this.count.title = "One region for each node";
    this.count.classList.toggle("warn", !good);
    this.applyButton.disabled = !good;
    this.draw();
  }

  async #apply() {
    const reply = await this.app.apply(maths.boxesForWire(this.boxes));
    if (reply.ok) this.close();
  }

  // Metres of the world to pixels and back.
  #scale() {
    return this.canvas.clientHeight / this.app.rig.topHeight;
  }

  #toPixels(x, y) {
    const [ox, oy] = this.app.origin();
    const { topCentre } = this.app.rig;
    const scale = this.#scale();
    const clamp = (value) => Math.max(-1e5, Math.min(1e5, value));
    return [clamp((x - ox - topCentre.x) * scale + this.canvas.clientWidth / 2),
      clamp(this.canvas.clientHeight / 2 - (y - oy - topCentre.y) * scale)];
  }

  #toWorld(event) {
    const box = this.canvas.getBoundingClientRect();
    const [ox, oy] = this.app.origin();
    const { topCentre } = this.app.rig;
    const scale = this.#scale();
    return [(event.clientX - box.left - box.width / 2) / scale + topCentre.x + ox,
      (box.height / 2 - (event.clientY - box.top)) / scale + topCentre.y + oy];
  }

  #borderNear([x, y]) {
    const reach = GRAB_PIXELS / this.#scale();
    const distance = (b) => Math.abs(b.at - (b.axis === 0 ? x : y));
    const along = (b) => (b.axis === 0 ? y : x);
    return maths.bordersOf(this.boxes)
      .filter((b) => distance(b) < reach && along(b) > b.from - reach && along(b) < b.to + reach)
      .sort((a, b) => distance(a) - distance(b))[0] ?? null;
  }

  #down(event) {
    this.canvas.setPointerCapture(event.pointerId);
    const at = this.#toWorld(event);
    if (event.button === 1) this.held = { pans: true, x: event.clientX, y: event.clientY };
    if (event.button !== 0) return;
    const border = this.#borderNear(at);
    if (border) this.held = { border: event.shiftKey ? maths.wholeLine(this.boxes, border) : border, boxes: this.boxes };
    else this.held = { from: at, to: at, x: event.clientX, y: event.clientY };
  }

  #move(event) {
    const at = this.#toWorld(event);
    const { held } = this;
    if (!held) {
      const border = this.#borderNear(at);
      this.canvas.style.cursor = border ? (border.axis === 0 ? "ew-resize" : "ns-resize") : "crosshair";
      this.hovered = border;
    } else if (held.pans) {
      const scale = this.#scale();
      this.app.rig.topCentre.x -= (event.clientX - held.x) / scale;
      this.app.rig.topCentre.y += (event.clientY - held.y) / scale;
      [held.x, held.y] = [event.clientX, event.clientY];
    } else if (held.border) {
      this.boxes = maths.moveBorder(held.boxes, held.border, snapped(at[held.border.axis]));
      this.#changed();
    } else {
      held.to = at;
      held.moved = Math.hypot(event.clientX - held.x, event.clientY - held.y) > 12;
      if (held.moved) this.boxes = maths.pattern(this.kind, this.#wanted(), this.#dragged());
      this.#changed();
    }
    this.draw();
  }

  #dragged() {
    const { from, to } = this.held;
    const low = [0, 1].map((i) => snapped(Math.min(from[i], to[i])));
    const high = [0, 1].map((i) => Math.max(low[i] + 4, snapped(Math.max(from[i], to[i]))));
    return [...low, ...high];
  }

  #up() {
    this.held = null;
    this.draw();
  }

  /** Across the region's shorter side; an infinite side is the longer one. */
  #cut(event) {
    const [x, y] = this.#toWorld(event);
    const index = maths.regionAt(this.boxes, x, y);
    if (index < 0) return;
    const [x0, y0, x1, y1] = this.boxes[index];
    const axis = event.shiftKey === (x1 - x0 >= y1 - y0) ? 1 : 0;
    this.boxes = maths.cutRegion(this.boxes, index, axis, snapped(axis === 0 ? x : y));
    this.#changed();
  }

  #join(event) {
    const border = this.#borderNear(this.#toWorld(event));
    if (border) this.boxes = maths.joinAcross(this.boxes, border);
    this.#changed();
  }

  #zoom(event) {
    event.preventDefault();
    const factor = Math.exp(Math.max(-60, Math.min(60, event.deltaY)) * 0.0022);
    this.app.rig.topHeight = Math.max(8, Math.min(4000, this.app.rig.topHeight * factor));
    this.draw();
  }

  draw() {
    if (!this.open) return;
    const { pen, canvas } = this;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      [canvas.width, canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    }
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    this.boxes.forEach((box, i) => this.#drawRegion(box, i, width, height));
    for (const border of maths.bordersOf(this.boxes)) this.#drawBorder(border);
    if (this.held?.moved) this.#drawDragged();
  }

  #drawRegion([x0, y0, x1, y1], index, width, height) {
    const clampX = (v) => Math.max(0, Math.min(width, v));
    const clampY = (v) => Math.max(0, Math.min(height, v));
    const [left, bottom] = this.#toPixels(x0, y0);
    const [right, top] = this.#toPixels(x1, y1);
    const [l, r, t, b] = [clampX(left), clampX(right), clampY(top), clampY(bottom)];
    const { pen } = this;
    pen.fillStyle = `${colourOfHost(index)}2b`;
    pen.fillRect(l, t, r - l, b - t);
    if (r - l < 40 || b - t < 30) return;
    pen.font = "600 17px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.fillStyle = colourOfHost(index);
    pen.fillText(`region ${index}`, (l + r) / 2, (t + b) / 2);
    pen.font = "12px system-ui, sans-serif";
    pen.fillStyle = "rgba(225,232,245,.7)";
    const size = (a, z) => (Number.isFinite(z - a) ? `${Number((z - a).toFixed(2))} m` : "∞");
    pen.fillText(`${size(x0, x1)} × ${size(y0, y1)}`, (l + r) / 2, (t + b) / 2 + 19);
  }

  #drawBorder(border) {
    const { pen } = this;
    const active = this.held?.border ?? this.hovered;
    const lit = active && active.axis === border.axis && Math.abs(active.at - border.at) < 1e-6
      && border.from < active.to && border.to > active.from;
    const ends = border.axis === 0
      ? [[border.at, border.from], [border.at, border.to]] : [[border.from, border.at], [border.to, border.at]];
    const [[ax, ay], [bx, by]] = ends.map(([x, y]) => this.#toPixels(x, y));
    pen.strokeStyle = lit ? "#ffffff" : "rgba(190,210,245,.75)";
    pen.lineWidth = lit ? 3 : 1.6;
    pen.setLineDash(this.app.coupled() ? [9, 7] : []);
    pen.beginPath();
    pen.moveTo(ax, ay);
    pen.lineTo(bx, by);
    pen.stroke();
    pen.setLineDash([]);
    if (!this.held?.border || !lit) return;
    pen.fillStyle = "#ffffff";
    pen.font = "600 13px system-ui, sans-serif";
    pen.textAlign = "left";
    const [x, y] = this.#toPixels(border.axis === 0 ? border.at : this.app.rig.topCentre.x, border.axis === 1 ? border.at : this.app.rig.topCentre.y);
    pen.fillText(`${"xy"[border.axis]} = ${border.at} m`, x + 8, y - 8);
  }

  #drawDragged() {
    const [x0, y0, x1, y1] = this.#dragged();
    const [left, bottom] = this.#toPixels(x0, y0);
    const [right, top] = this.#toPixels(x1, y1);
    this.pen.setLineDash([6, 5]);
    this.pen.strokeStyle = "#ffffff";
    this.pen.lineWidth = 1.2;
    this.pen.strokeRect(left, top, right - left, bottom - top);
    this.pen.setLineDash([]);
  }
}

const snapped = (x) => Math.round(x / SNAP) * SNAP;
