// Pointer and keys on the picture: gestures go to the camera, clicks and holds to the tool in hand.

const CLICK_PIXELS = 5;

export class Input {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {{rig: import("./camera.js").CameraRig, tools: import("./tools.js").Tools, tool: () => string}} app
   */
  constructor(canvas, app) {
    this.canvas = canvas;
    this.app = app;
    this.pointers = new Map();
    this.hover = null;
    canvas.addEventListener("pointerdown", (event) => this.#down(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => this.#up(event));
    canvas.addEventListener("pointerleave", () => { this.hover = null; });
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      app.rig.zoom(Math.exp(Math.max(-60, Math.min(60, event.deltaY)) * 0.0022));
    }, { passive: false });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  /** -1 to 1 */
  #at(event) {
    const box = this.canvas.getBoundingClientRect();
    return { x: ((event.clientX - box.left) / box.width) * 2 - 1, y: 1 - ((event.clientY - box.top) / box.height) * 2 };
  }

  #down(event) {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    const pans = event.button === 2 || event.button === 1 || event.shiftKey;
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY, startX: event.clientX, startY: event.clientY, pans, moved: false });
    if (this.pointers.size > 1) {
      this.app.tools.endDrag();
    } else if (!pans && this.app.tool() === "drag" && this.app.tools.beginDrag(this.#at(event))) {
      this.pointers.get(event.pointerId).drags = true;
    }
  }

  #move(event) {
    this.hover = this.#at(event);
    const pointer = this.pointers.get(event.pointerId);
    if (!pointer) return;
    const [dx, dy] = [event.clientX - pointer.x, event.clientY - pointer.y];
    if (Math.hypot(event.clientX - pointer.startX, event.clientY - pointer.startY) > CLICK_PIXELS) pointer.moved = true;
    if (this.pointers.size === 2) this.#pinch(pointer, event, dx, dy);
    else if (pointer.drags && this.app.tools.drag) this.app.tools.moveDrag(this.hover);
    else if (pointer.pans) this.app.rig.pan(dx, dy, this.canvas.clientHeight);
    else if (pointer.moved) this.app.rig.turn(dx, dy);
    [pointer.x, pointer.y] = [event.clientX, event.clientY];
  }

  #pinch(pointer, event, dx, dy) {
    const other = [...this.pointers.values()].find((p) => p !== pointer);
    const before = Math.hypot(pointer.x - other.x, pointer.y - other.y);
    const after = Math.hypot(event.clientX - other.x, event.clientY - other.y);
    if (before > 10 && after > 10) this.app.rig.zoom(before / after);
    this.app.rig.pan(dx / 2, dy / 2, this.canvas.clientHeight);
    pointer.moved = other.moved = true;
  }

  #up(event) {
    const pointer = this.pointers.get(event.pointerId);
    this.pointers.delete(event.pointerId);
    if (!pointer) return;
    if (pointer.drags) return this.app.tools.endDrag();
    if (pointer.moved || pointer.pans || event.type === "pointercancel") return;
    const at = this.#at(event);
    const tool = this.app.tool();
    if (tool === "push") this.app.tools.pushBody(at);
    else if (tool === "place") this.app.tools.placeAt(at);
    else this.app.tools.pickBody(at);
  }
}

/**
 * @param {Record<string, () => void>} actions  by key, as in KeyboardEvent.key, letters small
 * @param {import("./camera.js").CameraRig | null} rig
 */
export function listenToKeys(actions, rig) {
  const walks = new Set(["w", "a", "s", "d", "q", "e", "shift"]);
  const typing = (target) => target instanceof HTMLElement
    && (target.matches("input:not([type=range]):not([type=checkbox]), select, textarea") || target.closest("dialog"));
  window.addEventListener("keydown", (event) => {
    if (typing(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key.toLowerCase();
    if (rig && walks.has(key)) rig.keys.add(key);
    // A button in focus is pressed by space and by nothing else.
    if (key === " " && event.target instanceof HTMLButtonElement) return;
    const action = actions[key];
    if (!action || (event.repeat && key !== ".")) return;
    event.preventDefault();
    action();
  });
  window.addEventListener("keyup", (event) => rig?.keys.delete(event.key.toLowerCase()));
  window.addEventListener("blur", () => rig?.keys.clear());
}
