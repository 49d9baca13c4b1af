// What the run says about itself: the bar at the top, the nodes at the left.
import { colourOfHost } from "./colours.js";
import { clockTime, fixed, grouped, h } from "./dom.js";
import { Sparkline } from "./sparkline.js";

const VIOLATIONS = ["speed", "latency", "frame", "promise", "span"];

export class TopBar {
  constructor() {
    this.state = document.getElementById("run-state");
    this.link = document.getElementById("link-state");
    this.meters = document.getElementById("meters");
    this.time = h("span.number");
    this.step = h("span.number.dim");
    this.badge = h("span.badge");
    this.state.append(this.badge, this.time, this.step);
    this.bodies = h("b");
    this.fps = h("b");
    this.quality = h("span.dim");
    this.meters.append(h("span", {}, this.bodies, " bodies"), h("span", {}, this.fps, " fps ", this.quality));
    this.showLink("connecting");
  }

  showRun(state, rate, step, step_s) {
    this.badge.textContent = state ?? "–";
    this.badge.dataset.state = state ?? "none";
    this.time.textContent = Number.isFinite(step) ? `${clockTime(step * step_s)} s` : "";
    this.step.textContent = Number.isFinite(step) ? `step ${grouped(step)}` : "";
    if (Number.isFinite(rate) && Math.abs(rate - 1) > 1e-3) this.step.textContent += `  ·  ${Number(rate.toFixed(2))}×`;
  }

  showLink(state, text) {
    this.link.dataset.state = state;
    this.link.textContent = text ?? { connecting: "connecting", open: "live", replay: "replay", closed: "offline" }[state];
  }

  showPicture(bodies, fps, quality) {
    this.bodies.textContent = grouped(bodies);
    this.fps.textContent = fps ? fixed(fps, 0) : "–";
    this.quality.textContent = quality;
  }
}

/** One node's card. */
class NodeCard {
  constructor(region) {
    const colour = colourOfHost(region);
    this.spark = new Sparkline(colour);
    this.values = {};
    const cell = (key, label, title) => h("div.cell", { title }, (this.values[key] = h("b")), h("span", {}, label));
    this.state = h("span.node-state");
    this.violations = h("div.violations", { hidden: true });
    this.p50 = h("b.big");
    this.text = h("p.node-text", { hidden: true });
    this.element = h("article.node", { style: `--host: ${colour}`, "data-region": region, "aria-label": `Region ${region}` },
      h("header", {}, h("i.swatch"), h("h3", {}, `Region ${region}`), this.state),
      h("div.timing", {}, h("div.frame-time", {}, this.p50, h("span", {}, "ms")), this.spark.canvas),
      h("div.cells", {},
        cell("p99", "p99 ms", "99th percentile of the frame time"), cell("max", "max ms", "Longest frame"),
        cell("rtf", "real time", "Simulated seconds per second"), cell("bodies", "bodies", "Bodies hosted here"),
        cell("awake", "awake", "Bodies that move"), cell("handOffs", "hand-offs/s", "Bodies handed over per second")),
      this.violations, this.text);
  }

  show(node, step_s) {
    const frame = node.frame_ms ?? {};
    const set = (key, text) => { this.values[key].textContent = text; };
    this.state.textContent = node.lost ? "lost" : node.state;
    this.state.dataset.state = node.lost ? "lost" : node.state;
    this.element.classList.toggle("lost", Boolean(node.lost));
    this.p50.textContent = fixed(frame.p50, 2);
    set("p99", fixed(frame.p99, 1));
    set("max", fixed(frame.max, 1));
    set("bodies", grouped(node.bodies));
    set("awake", grouped(node.awake));
    set("handOffs", fixed(node.hand_offs_per_s, 1));
    set("rtf", `${fixed(node.real_time_factor, 2)}×`);
    this.values.rtf.classList.toggle("warn", node.state === "running" && node.real_time_factor < 0.95);
    this.#showViolations(node.violations ?? {});
    this.text.hidden = !node.text;
    this.text.textContent = node.text ?? "";
    this.spark.push(frame.p99, step_s * 1000);
  }

  #showViolations(violations) {
    const broken = VIOLATIONS.filter((kind) => violations[kind] > 0);
    this.violations.hidden = broken.length === 0;
    this.violations.replaceChildren(
      ...broken.map((kind) => h("span", { title: `Broken promises: ${kind}` }, `${kind} `, h("b", {}, grouped(violations[kind])))));
  }
}

export class NodesPanel {
  constructor() {
    this.element = document.getElementById("nodes");
    this.total = h("span.dim");
    this.list = h("div.node-list");
    this.element.append(h("header.panel-head", {}, h("h2", {}, "Nodes"), this.total), this.list);
    this.cards = new Map();
    this.clear();
  }

  clear() {
    this.cards.clear();
    this.list.replaceChildren(h("p.empty", {}, "No node has said anything yet."));
    this.total.textContent = "";
  }

  show(nodes, step_s) {
    const regions = nodes.map((node) => node.region);
    const known = [...this.cards.keys()];
    if (regions.length !== known.length || regions.some((region) => !this.cards.has(region))) {
      this.cards = new Map(regions.map((region) => [region, this.cards.get(region) ?? new NodeCard(region)]));
      this.list.replaceChildren(...[...this.cards.values()].map((card) => card.element));
    }
    for (const node of nodes) this.cards.get(node.region).show(node, step_s);
    const broken = nodes.reduce((sum, n) => sum + VIOLATIONS.reduce((s, kind) => s + (n.violations?.[kind] ?? 0), 0), 0);
    const handOffs = nodes.reduce((sum, n) => sum + (n.hand_offs_per_s ?? 0), 0);
    this.total.textContent = `${fixed(handOffs, 1)} hand-offs/s  ·  ${broken ? `${grouped(broken)} broken` : "no violations"}`;
    this.total.classList.toggle("warn", broken > 0);
  }
}
