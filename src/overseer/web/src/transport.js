// Time: pause, step, slow motion, reset; in a replay the bar to seek in.
import { choice, clockTime, h, icon, iconButton } from "./dom.js";

const SLOWEST = 0.05;
const FASTEST = 4;

/** The slider is logarithmic: 0 is the slowest, 1 the fastest. */
const rateOf = (x) => {
  const rate = SLOWEST * (FASTEST / SLOWEST) ** x;
  return Math.abs(rate - 1) < 0.06 ? 1 : Number(rate.toPrecision(2));
};
const sliderOf = (rate) => Math.log(rate / SLOWEST) / Math.log(FASTEST / SLOWEST);

export class Transport {
  /** @param {{command: Function, replay: Function}} out */
  constructor(out) {
    this.out = out;
    this.element = document.getElementById("transport");
    this.mode = null;
    this.running = false;
    this.rate = 1;
    /** Names of the worlds that this page has had saved, the newest last. */
    this.kept = [];
    this.setMode("live");
  }

  /** @param {number} first  place in a replay at which it begins @param {number[]} resets  places in it */
  setMode(mode, first = 0, last = 1, resets = [], step_s = 1 / 60) {
    Object.assign(this, { first, last: Math.max(last, first + 1), resets, step_s, at: first });
    this.mode = mode;
    this.element.dataset.mode = mode;
    this.play = iconButton("pause", "Pause (space)", () => this.toggle(), { class: "icon primary" });
    if (mode === "replay") this.#buildReplay();
    else this.#buildLive();
  }

  #buildLive() {
    this.slider = h("input", { type: "range", min: 0, max: 1, step: 0.01, value: sliderOf(1), "aria-label": "Speed",
      oninput: () => this.#showRate(rateOf(Number(this.slider.value))),
      onchange: () => this.setRate(rateOf(Number(this.slider.value))) });
    this.backButton = iconButton("back", "Back to the moment kept last (n)", () => this.goBack(), { disabled: this.kept.length === 0 });
    this.rateText = h("button.rate", { type: "button", title: "Back to real time", onclick: () => this.setRate(1) });
    this.element.replaceChildren(
      this.play,
      iconButton("before", "To an earlier state (,)", () => this.stepBack()),
      iconButton("step", "One step (.)", () => this.step(1)),
      iconButton("reset", "Reset (x)", () => this.out.command({ kind: "reset" })),
      iconButton("keep", "Keep this moment (m)", () => this.keep()),
      this.backButton,
      h("span.rule"), h("span.label", {}, "Speed"), this.slider, this.rateText);
    this.#showRate(this.rate);
  }

  #buildReplay() {
    this.position = h("span.number");
    this.seekBar = h("input", { type: "range", min: this.first, max: this.last, step: 1,
      value: this.first, "aria-label": "Position in the replay",
      oninput: () => {
        this.seekingUntil = performance.now() + 600;
        this.#showPosition(Number(this.seekBar.value));
        this.out.replay("seek", Number(this.seekBar.value));
      } });
    this.speed = choice("Replay speed", [0.25, 0.5, 1, 2, 4].map((x) => ({ value: String(x), text: `${x}×` })), "1",
      (value) => this.out.replay("speed", Number(value)));
    const marks = this.resets.map((at) => h("i", { style: `left: ${this.#percent(at)}%`, title: "The run was reset here" }));
    this.element.replaceChildren(this.play, h("div.seek", {}, this.seekBar, ...marks), this.position, this.speed.element);
    this.#showPosition(this.first);
  }

  #percent(at) {
    return (100 * (at - this.first)) / (this.last - this.first);
  }

  #showPosition(at) {
    this.position.textContent = `${clockTime(at * this.step_s)} / ${clockTime(this.last * this.step_s)}`;
  }

  #showRate(rate) {
    this.rateText.textContent = `${rate}×`;
    this.rateText.classList.toggle("changed", rate !== 1);
    this.slider.style.setProperty("--fill", `${Number(this.slider.value) * 100}%`);
  }

  setRate(rate) {
    this.rate = Math.min(10, Math.max(0.01, rate));
    if (this.slider) this.slider.value = String(sliderOf(this.rate));
    this.#showRate(this.rate);
    this.out.command({ kind: "rate", value: this.rate }, { what: `speed ${this.rate}×` });
  }

  /** The nodes save the world. */
  async keep() {
    if (this.mode !== "live") return;
    const name = `page-${Date.now().toString(36)}-${Math.random().toString(36).slice(2, 6)}.cut`;
    const reply = await this.out.command({ kind: "save", name }, { what: "keep" });
    if (!reply.ok) return;
    this.kept.push(name);
    this.backButton.disabled = false;
  }

  /** Once, to the newest; again from there, to the one before it. */
  async goBack() {
    if (this.mode !== "live" || this.kept.length === 0) return;
    const reply = await this.out.command({ kind: "load", name: this.kept.at(-1) }, { what: "back" });
    if (reply.ok && this.kept.length > 1) this.kept.pop();
  }

  /** To the newest earlier state that the nodes keep; once more, to the one before that. */
  stepBack() {
    if (this.mode === "live") return void this.out.command({ kind: "back" }, { what: "earlier" });
    this.out.replay("seek", Math.max(this.first, this.at - Math.round(1 / this.step_s)));
  }

  faster(factor) {
    if (this.mode === "live") this.setRate(Number(Math.min(FASTEST, Math.max(SLOWEST, this.rate * factor)).toPrecision(2)));
  }

  toggle() {
    if (this.mode === "replay") this.out.replay(this.running ? "pause" : "play");
    else this.out.command({ kind: this.running ? "pause" : "resume" });
  }

  step(count) {
    if (this.mode === "live") return void this.out.command({ kind: "step", count }, { quiet: true });
    this.out.replay("seek", Math.min(this.last, this.at + count));
  }

  /** From the status. */
  showRunning(running) {
    if (running === this.running) return;
    this.running = running;
    this.play.replaceChildren(icon(running ? "pause" : "play"));
    const label = running ? "Pause (space)" : "Go on (space)";
    this.play.setAttribute("aria-label", label);
    this.play.title = label;
  }

  showRate(rate) {
    // Not while the user has it in hand.
    if (this.mode !== "live" || !(rate > 0) || document.activeElement === this.slider || rate === this.rate) return;
    this.rate = Number(rate.toPrecision(3));
    this.slider.value = String(sliderOf(rate));
    this.#showRate(this.rate);
  }

  showReplay({ at, playing, speed }) {
    this.at = at;
    this.showRunning(playing);
    this.speed?.set(String(speed));
    if (performance.now() < (this.seekingUntil ?? 0)) return;
    this.seekBar.value = String(at);
    this.seekBar.style.setProperty("--fill", `${this.#percent(at)}%`);
    this.#showPosition(at);
  }
}
