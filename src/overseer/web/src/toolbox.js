// The panel at the right: which tool is in hand and its settings, what is shown, what is selected.
import { colourOfHost } from "./colours.js";
import { choice, fixed, h, icon, iconButton, numberField, toggle } from "./dom.js";

export const TOOLS = ["select", "push", "drag", "place"];
const WHAT_TOOLS_DO = {
  select: "Click a body to see who hosts it.",
  push: "Click a body: it gets a blow away from you.",
  drag: "Hold a body and move it.",
  place: "Click on the ground or on something that stands there.",
};

export class Toolbox {
  /**
   * @param {{onTool: Function, onShow: Function, onThrow: Function, onFile: Function, onRemove: Function, onRegions: Function}} on
   */
  constructor(on, show) {
    this.on = on;
    this.element = document.getElementById("tools");
    this.tool = "select";
    this.mesh = null;
    this.options = h("div.options");
    this.toolChoice = choice("Tool", TOOLS.map((tool, i) => ({ value: tool, symbol: tool, text: tool, title: `${tool} (${i + 1})` })),
      "select", (tool) => this.setTool(tool));
    this.#buildPlace();
    this.push = numberField("Strength", 8, { min: 0.1, max: 1000, step: 1, unit: "N s" });
    this.commandParts = h("div", {},
      this.#section("Tool", this.toolChoice.element, this.options), this.#throwSection());
    this.selection = h("div.selection");
    this.element.append(this.#section("Selected", this.selection), this.commandParts, this.#showSection(show));
    this.setTool("select");
    this.showNothing();
  }

  #section(title, ...children) {
    return h("section", {}, h("h2", {}, title), ...children);
  }

  #throwSection() {
    this.throwShape = "sphere";
    this.throwSize = numberField("Size", 0.6, { min: 0.05, max: 10, step: 0.1, unit: "m" });
    this.throwSpeed = numberField("Speed", 18, { min: 0, max: 60, step: 1, unit: "m/s" });
    this.throwMass = numberField("Mass", 4, { min: 0.01, max: 10000, step: 1, unit: "kg" });
    const shape = choice("Shape to throw", [{ value: "sphere", text: "Sphere" }, { value: "box", text: "Box" }], "sphere",
      (value) => { this.throwShape = value; });
    return this.#section("Throw", h("div.row", {}, shape.element,
      h("button.primary", { type: "button", id: "throw", onclick: () => this.on.onThrow() }, icon("throw"), "Throw", h("kbd", {}, "T"))),
    h("div.fields.three", {}, this.throwSize.element, this.throwSpeed.element, this.throwMass.element));
  }

  #buildPlace() {
    this.placeWhat = "box";
    this.placeAs = "static";
    this.sizes = ["X", "Y", "Z"].map((axis, i) => numberField(axis, [2, 2, 1][i], { min: 0.05, max: 200, step: 0.5, unit: "m" }));
    this.yaw = numberField("Turned", 0, { min: -180, max: 180, step: 15, unit: "°" });
    this.meshMass = numberField("Mass", 5, { min: 0.01, max: 10000, step: 1, unit: "kg" });
    const what = choice("What to place", [{ value: "box", text: "Static box" }, { value: "mesh", text: "Mesh file" }], "box",
      (value) => { this.placeWhat = value; this.#showPlace(); });
    const file = h("input.sr", { type: "file", accept: ".obj,.stl,.gltf,.glb", id: "mesh-file", "aria-label": "Mesh file",
      onchange: () => { if (file.files[0]) this.on.onFile(file.files[0]); file.value = ""; } });
    this.fileName = h("span.dim", {}, "OBJ, STL, glTF");
    const as = choice("Place the mesh as", [{ value: "static", text: "Static" }, { value: "hull", text: "Hull", title: "Falls, as its convex hull" },
      { value: "decomposition", text: "Parts", title: "Falls, decomposed into convex parts" }], "static", (value) => { this.placeAs = value; });
    this.boxOptions = h("div.fields.three", {}, ...this.sizes.map((f) => f.element));
    this.meshOptions = h("div", {}, h("div.row", {}, h("label.button", { for: "mesh-file" }, "Choose…"), file, this.fileName),
      as.element, this.meshMass.element);
    this.place = h("div", {}, what.element, this.boxOptions, this.meshOptions, this.yaw.element);
    this.#showPlace();
  }

  #showPlace() {
    this.boxOptions.hidden = this.placeWhat !== "box";
    this.meshOptions.hidden = this.placeWhat !== "mesh";
    this.on.onTool?.(this.tool);
  }

  #showSection(show) {
    const entries = [["regions", "Borders", "B"], ["auras", "Auras", "U"], ["links", "Cluster links", "L"],
      ["contacts", "Contacts", "K"], ["velocity", "Velocities", "V"]];
    this.toggles = {};
    const list = h("div.toggles", {}, ...entries.map(([key, label, letter]) => {
      const made = toggle(label, show[key], (on) => this.on.onShow(key, on), letter);
      made.input.id = `show-${key}`;
      this.toggles[key] = made.input;
      return made.element;
    }));
    return this.#section("Show", list);
  }

  flip(key) {
    this.toggles[key].checked = !this.toggles[key].checked;
    this.on.onShow(key, this.toggles[key].checked);
  }

  setTool(tool) {
    this.tool = tool;
    this.toolChoice.set(tool);
    const body = { push: this.push.element, place: this.place }[tool];
    this.options.replaceChildren(h("p.dim", {}, WHAT_TOOLS_DO[tool]), ...(body ? [body] : []));
    this.on.onTool(tool);
  }

  /** In a replay nothing can be changed. */
  setMode(mode) {
    this.commandParts.hidden = mode === "replay";
    if (mode === "replay") this.setTool("select");
  }

  setMesh(name, shape) {
    this.mesh = shape;
    this.fileName.textContent = `${name} · ${shape.triangles} triangles`;
  }

  settings() {
    return {
      push: this.push.value,
      throw: { shape: this.throwShape, size: this.throwSize.value, speed: this.throwSpeed.value, mass: this.throwMass.value },
      place: { what: this.placeWhat, as: this.placeAs, size: this.sizes.map((f) => f.value), yaw_deg: this.yaw.value,
        mass: this.meshMass.value, mesh: this.mesh },
    };
  }

  showNothing() {
    this.selection.replaceChildren(h("p.dim", {}, "Nothing. Click a body."));
    this.rows = null;
  }

  showStatic(body) {
    this.rows = null;
    this.selection.replaceChildren(this.#head("#69748a", body.name || `static ${body.id}`, "does not move"));
  }

  #head(colour, title, subtitle) {
    return h("div.selected-head", { style: `--host: ${colour}` }, h("i.swatch"),
      h("div", {}, h("b", {}, title), h("span.dim", {}, subtitle)),
      iconButton("trash", "Remove (Del)", () => this.on.onRemove(), { id: "remove" }));
  }

  /** @param {{id: number, host: number, epoch: number, speed?: number, awake: boolean, prototype: string, p: number[]}} body */
  showBody(body) {
    const known = this.rows && this.rows.id === body.id && this.rows.host === body.host;
    if (!known) {
      const values = {};
      const row = (key, label) => [h("dt", {}, label), (values[key] = h("dd"))];
      this.rows = { id: body.id, host: body.host, values };
      this.selection.replaceChildren(
        this.#head(colourOfHost(body.host), `Body ${body.id}`, body.prototype),
        h("dl", {}, ...row("host", "Host"), ...row("epoch", "Epoch"), ...row("speed", "Speed"), ...row("awake", "State"), ...row("p", "At")));
    }
    const { values } = this.rows;
    values.host.textContent = `region ${body.host}`;
    values.epoch.textContent = `${body.epoch} ${body.epoch === 1 ? "hand-off" : "hand-offs"}`;
    values.speed.textContent = `${fixed(body.speed, 2)} m/s`;
    values.awake.textContent = body.awake ? "awake" : "asleep";
    values.p.textContent = body.p.map((x) => fixed(x, 2)).join("  ");
  }
}
