// What the run says about itself: the bar at the top, the nodes at the left.
import { colourOfHost } from "./colours.js";
import { clockTime, fixed, grouped, h } from "./dom.js";
import { Sparkline } from "./sparkline.js";
import { ABOUT_LATE, ABOUT_WARNINGS, lateOf, sumOf, warningsOf } from "./warnings.js";

/** With more nodes than this a card shows the least, and the rest when it is clicked. */
const FEW_NODES = 4;

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

const ABOUT_LISTENING = "Regions whose nodes and this one hear each other. Those that are not near each other on the map " +
  "were introduced by a third, because bodies came near.";

const ABOUT_EXCHANGE = "How bodies of two regions touch. Aura: one node hosts both of them in time. Coupled: their nodes solve the " +
  "contact together, with several exchanges in each step, and their borders are drawn dashed. The times are those of the slowest " +
  "node in the last second.";

/** How bodies of two regions touch, and what an exchange of coupled regions takes. */
function exchangeOf(nodes) {
  const known = nodes.filter(({ exchange }) => exchange === "aura" || exchange === "coupled");
  if (known.length === 0) return "";
  const slowest = known.reduce((a, b) => ((b.exchange_ms?.p99 ?? 0) > (a.exchange_ms?.p99 ?? 0) ? b : a));
  const { p50 = 0, p99 = 0 } = slowest.exchange_ms ?? {};
  return p99 > 0 ? `${slowest.exchange}: ${fixed(p50, 2)} ms an exchange, p99 ${fixed(p99, 2)} ms` : slowest.exchange;
}

/** One node's card. */
class NodeCard {
  constructor(region) {
    const colour = colourOfHost(region);
    this.spark = new Sparkline(colour);
    this.values = {};
    const cell = (key, label, title) => h("div.cell", { title }, (this.values[key] = h("b")), h("span", {}, label));
    this.state = h("span.node-state");
    this.warnings = h("div.warnings", { hidden: true });
    this.brief = h("span.brief");
    this.p50 = h("b.big");
    this.text = h("p.node-text", { hidden: true });
    this.listens = h("span.node-listens", { hidden: true });
    this.element = h("article.node", { style: `--host: ${colour}`, "data-region": region, "aria-label": `Region ${region}` },
      h("header", { tabindex: 0, onclick: () => this.#flip(), onkeydown: (event) => event.key === "Enter" && this.#flip() },
        h("i.swatch"), h("h3", {}, `Region ${region}`), this.brief, this.listens, this.state),
      h("div.timing", {}, h("div.frame-time", {}, this.p50, h("span", {}, "ms")), this.spark.canvas),
      h("div.cells", {},
        cell("p99", "p99 ms", "99th percentile of the frame time"), cell("max", "max ms", "Longest frame"),
        cell("rtf", "real time", "Simulated seconds per second"), cell("bodies", "bodies", "Bodies hosted here"),
        cell("awake", "awake", "Bodies that move"), cell("handOffs", "hand-offs/s", "Bodies handed over per second")),
      this.warnings, this.text);
  }

  #flip() {
    this.element.classList.toggle("open");
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
    this.brief.textContent = `${grouped(node.bodies)} bodies`;
    this.#showWarnings(node);
    this.#showListening(node.listens_to ?? []);
    this.text.hidden = !node.text;
    this.text.textContent = node.text ?? "";
    this.spark.push(frame.p99, step_s * 1000);
  }

  /** Regions near each other always listen; of the others it matters since when. */
  #showListening(regions) {
    this.listens.hidden = regions.length === 0;
    this.listens.textContent = `hears ${regions.map(({ region }) => region).join(", ")}`;
    const introductions = regions.filter((one) => one.introduced_by !== undefined)
      .map(({ region, since, introduced_by: by }) => `Region ${region}: since state ${grouped(since)}, introduced by ${by}.`);
    this.listens.title = [ABOUT_LISTENING, ...introductions].join("\n");
  }

  #showWarnings(node) {
    const late = lateOf(node);
    const chips = warningsOf(node).map(({ name, means, count }) => h("span", { title: means }, `${name} `, h("b", {}, grouped(count))));
    if (late > 0) chips.unshift(h("span.late", { title: ABOUT_LATE }, "late ", h("b", {}, grouped(late))));
    this.warnings.hidden = chips.length === 0;
    this.warnings.replaceChildren(...chips);
    this.element.classList.toggle("has-late", late > 0);
  }
}

export class NodesPanel {
  constructor() {
    this.element = document.getElementById("nodes");
    this.handOffs = h("span");
    this.warnings = h("span", { title: ABOUT_WARNINGS });
    this.late = h("span", { title: ABOUT_LATE });
    this.exchange = h("span", { title: ABOUT_EXCHANGE });
    this.list = h("div.node-list");
    this.element.append(h("header.panel-head", {}, h("h2", {}, "Nodes"),
      h("p.totals", {}, this.handOffs, this.warnings, this.late, this.exchange)), this.list);
    this.cards = new Map();
    this.clear();
  }

  clear() {
    this.cards.clear();
    this.list.replaceChildren(h("p.empty", {}, "No node has said anything yet."));
    for (const total of [this.handOffs, this.warnings, this.late, this.exchange]) total.textContent = "";
    this.late.classList.remove("alarm");
  }

  show(nodes, step_s) {
    const regions = nodes.map((node) => node.region);
    const known = [...this.cards.keys()];
    if (regions.length !== known.length || regions.some((region) => !this.cards.has(region))) {
      this.cards = new Map(regions.map((region) => [region, this.cards.get(region) ?? new NodeCard(region)]));
      this.list.replaceChildren(...[...this.cards.values()].map((card) => card.element));
    }
    for (const node of nodes) this.cards.get(node.region).show(node, step_s);
    this.list.classList.toggle("many", nodes.length > FEW_NODES);
    const handOffs = nodes.reduce((sum, n) => sum + (n.hand_offs_per_s ?? 0), 0);
    const { warnings, late } = sumOf(nodes);
    this.handOffs.textContent = `${fixed(handOffs, 1)} hand-offs/s`;
    this.warnings.textContent = warnings > 0 ? `${grouped(warnings)} ${warnings === 1 ? "warning" : "warnings"}` : "";
    this.late.textContent = late > 0 ? `${grouped(late)} late` : late === 0 ? "none late" : "";
    this.late.classList.toggle("alarm", late > 0);
    this.exchange.textContent = nodes.length > 1 ? exchangeOf(nodes) : "";
  }
}
