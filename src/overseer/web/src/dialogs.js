// What comes over the page for a moment: toasts, the question for the token, help, and what to say when there is nothing.
import { h, iconButton } from "./dom.js";
import { ABOUT_LATE, ABOUT_WARNINGS, WARNINGS } from "./warnings.js";

const TOAST_MS = { ok: 2600, info: 3200, bad: 7000 };
const MOST_TOASTS = 5;

/** @param {"ok" | "bad" | "info"} kind */
export function toast(text, kind = "info") {
  const list = document.getElementById("toasts");
  const element = h("div.toast", { "data-kind": kind, role: kind === "bad" ? "alert" : null }, h("i"), h("span", {}, text));
  list.append(element);
  while (list.children.length > MOST_TOASTS) list.firstChild.remove();
  setTimeout(() => element.classList.add("leaving"), TOAST_MS[kind]);
  setTimeout(() => element.remove(), TOAST_MS[kind] + 300);
}

let asking = null;

const ASKED_TO = {
  operate: ["Watching is free; changing the run takes the token for operators that the overseer has printed or was started with.", "Only watch"],
  look: ["This run is shown to those who have a token: the overseer has printed it or was started with it.", "Not now"],
};

/** @param {"look" | "operate"} what @returns {Promise<string | null>} */
export function askForToken(what) {
  const [why, no] = ASKED_TO[what];
  asking ??= new Promise((resolve) => {
    const input = h("input", { type: "password", autocomplete: "off", "aria-label": "Token", placeholder: "Token" });
    const done = (value) => {
      asking = null;
      dialog.close();
      dialog.remove();
      resolve(value);
    };
    const form = h("form", { method: "dialog", onsubmit: (event) => { event.preventDefault(); done(input.value.trim() || null); } },
      h("h2", {}, "A token is needed"),
      h("p", {}, why),
      input,
      h("div.row.end", {}, h("button", { type: "button", onclick: () => done(null) }, no),
        h("button.primary", { type: "submit" }, "Use it")));
    const dialog = h("dialog.card", { "aria-label": "Token", oncancel: (event) => { event.preventDefault(); done(null); } }, form);
    document.body.append(dialog);
    dialog.showModal();
    input.focus();
  });
  return asking;
}

const HELP = [
  ["Look", [["drag", "turn"], ["right drag, shift drag", "move"], ["wheel, pinch", "nearer, farther"],
    ["W A S D Q E", "walk"], ["F", "show everything"], ["C", "orbit or fly"], ["H", "hide the panels"]]],
  ["Time", [["space", "pause, go on"], [".", "one step"], [",", "to an earlier state"], ["[  ]", "slower, faster"], ["X", "reset"],
    ["M", "keep this moment"], ["N", "back to it"]]],
  ["Bodies", [["click", "select"], ["1 2 3 4", "select, push, drag, place"], ["T", "throw from the camera"],
    ["Del", "remove what is selected"], ["Esc", "let go"]]],
  ["Show", [["B", "borders"], ["U", "auras"], ["L", "cluster links"], ["K", "contacts"], ["V", "velocities"],
    ["R", "draw the regions"]]],
];

let help = null;

export function toggleHelp() {
  if (help) {
    help.close();
    return;
  }
  help = h("dialog.card.help", { "aria-label": "Keys", onclose: () => { help.remove(); help = null; },
    onclick: (event) => event.target === help && help.close() },
  h("header.panel-head", {}, h("h2", {}, "Keys and mouse"), iconButton("close", "Close", () => help.close())),
  h("div.help-grid", {}, ...HELP.map(([title, rows]) => h("section", {}, h("h3", {}, title),
    h("dl", {}, ...rows.flatMap(([key, does]) => [h("dt", {}, ...key.split(", ").flatMap((k, i) => [i ? " " : null, h("kbd", {}, k)])), h("dd", {}, does)]))))),
  h("h3", {}, "Words"),
  h("dl.words", {}, ...Object.values(WARNINGS).flatMap(([name, means]) => [h("dt", {}, name), h("dd", {}, means)])),
  h("p.dim", {}, ABOUT_WARNINGS), h("p.dim", {}, ABOUT_LATE),
  h("p.dim", {}, "A body has the colour of the node that computes it. It flashes when it is handed over, and pales when it sleeps."));
  document.body.append(help);
  help.showModal();
}

/** Over the picture while there is nothing to see. `null` takes it away. */
export function curtain(title, text) {
  const element = document.getElementById("curtain");
  element.classList.toggle("open", title !== null);
  if (title === null || element.dataset.title === title + text) return;
  element.dataset.title = title + text;
  element.replaceChildren(h("div.waiting", { "aria-hidden": "true" }, h("i"), h("i"), h("i")), h("h1", {}, title), h("p", {}, text));
}

export function hint(text) {
  const element = document.getElementById("hint");
  element.hidden = !text;
  element.textContent = text ?? "";
}
