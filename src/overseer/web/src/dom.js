// Small things for building the page: elements, icons, numbers. Text is always text, never markup.

/**
 * @param {string} tag  "div", "div.class.other"
 * @param {Record<string, any>} [props]  attributes; functions become listeners (`onclick`)
 * @param {...(Node | string | null)} children
 */
export function h(tag, props = {}, ...children) {
  const [name, ...classes] = tag.split(".");
  const element = document.createElement(name);
  element.classList.add(...classes);
  for (const [key, value] of Object.entries(props)) {
    if (value === undefined || value === null || value === false) continue;
    if (typeof value === "function") element.addEventListener(key.slice(2), value);
    else if (key === "value" || key === "checked") element[key] = value;
    else if (key === "style") element.style.cssText = value; // the attribute is what the content policy forbids
    else element.setAttribute(key, value === true ? "" : String(value));
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

const ICONS = {
  play: "M8 5.5v13l10.5-6.5z",
  pause: "M7 5h3.6v14H7zM13.4 5H17v14h-3.6z",
  step: "M6 5.5v13l8.5-6.5zM16 5h2.6v14H16z",
  before: "M18 5.5v13l-8.5-6.500zM8 5H5.400v14H8z",
  reset: "M12 5a7 7 0 1 1-6.6 4.7l1.9.7A5 5 0 1 0 12 7v3L7.5 6 12 2z",
  keep: "M6 2h12v20l-6-5-6 5z",
  back: "M12 6v12l-8.5-6zM20 6v12l-8.500-6z",
  select: "M6 3l13 8.2-5.6 1.2 3.3 6.2-2.3 1.2-3.2-6.3L7 17.6z",
  push: "M3 11h9V7l8 5-8 5v-4H3z",
  drag: "M12 2l3.2 3.6h-2.1v5.3h5.3V8.8L22 12l-3.6 3.2v-2.1h-5.3v5.3h2.1L12 22l-3.2-3.6h2.1v-5.3H5.6v2.1L2 12l3.6-3.2v2.1h5.3V5.6H8.8z",
  place: "M12 2l8.5 4.7v9.8L12 21.5l-8.5-5V6.7zm0 2.3L6.6 7.4 12 10.5l5.4-3.1zM5.5 9.1v6.3l5.5 3.2v-6.3zm13 0L13 12.300v6.300l5.500-3.200z",
  throw: "M4 18.500C6 10 12 6 17 6.500l-2-2.500 6 3.500-5 4.500.8-3.300C12.500 8 8.500 11.500 6 19z",
  regions: "M3 3h8v8H3zm2 2v4h4V5zm8-2h8v11h-8zm2 2v7h4V5zM3 13h8v8H3zm2 2v4h4v-4zm8 1h8v5h-8zm2 2v1h4v-1z",
  frame: "M3 3h6v2H5v4H3zm12 0h6v6h-2V5h-4zM3 15h2v4h4v2H3zm16 0h2v6h-6v-2h4zM9 9h6v6H9z",
  fly: "M2 12l20-9-6.500 18-4-7.500z",
  help: "M12 2a10 10 0 1 1 0 20 10 10 0 0 1 0-20zm0 2a8 8 0 1 0 0 16 8 8 0 0 0 0-16zm-1 11.500h2v2h-2zM12 6.500c2.200 0 3.700 1.300 3.700 3.200 0 2.700-2.700 2.700-2.700 4.600h-2c0-3 2.600-3.100 2.600-4.600 0-.8-.6-1.300-1.600-1.300s-1.700.6-1.800 1.700l-2-.3c.2-2 1.700-3.300 3.800-3.300z",
  trash: "M9 3h6l1 2h4v2H4V5h4zM6 8.500h12L17 21H7z",
  panels: "M3 4h18v16H3zm2 2v12h5V6zm7 0v12h7V6z",
  close: "M6.400 5L12 10.600 17.600 5 19 6.400 13.400 12l5.600 5.600-1.400 1.400-5.600-5.600L6.400 19 5 17.600l5.600-5.600L5 6.400z",
};

export function icon(name) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS("http://www.w3.org/2000/svg", "path");
  path.setAttribute("d", ICONS[name]);
  svg.append(path);
  return svg;
}

/** @param {string} label  read out and shown as a tooltip */
export function iconButton(name, label, onclick, props = {}) {
  return h("button.icon", { type: "button", "aria-label": label, title: label, onclick, ...props }, icon(name));
}

/** A row of buttons of which one is pressed. */
export function choice(label, options, chosen, onchoose) {
  const group = h("div.choice", { role: "radiogroup", "aria-label": label });
  const set = (value) => {
    for (const button of group.children) {
      button.setAttribute("aria-checked", String(button.dataset.value === value));
    }
  };
  for (const { value, text, symbol, title } of options) {
    group.append(h("button", { type: "button", role: "radio", "data-value": value, title: title ?? text,
      "aria-label": title ?? text, onclick: () => { set(value); onchoose(value); } },
    symbol ? icon(symbol) : null, text ? h("span", {}, text) : null));
  }
  set(chosen);
  return { element: group, set };
}

export function toggle(label, on, onchange, key) {
  const input = h("input", { type: "checkbox", checked: on, onchange: () => onchange(input.checked) });
  const element = h("label.toggle", {}, input, h("span.switch"), h("span", {}, label), key ? h("kbd", {}, key) : null);
  return { element, input };
}

/** @param {{min?: number, max?: number, step?: number, unit?: string}} limits */
export function numberField(label, value, limits = {}) {
  const { unit, ...attributes } = limits;
  const input = h("input", { type: "number", value, ...attributes, "aria-label": label });
  const element = h("label.field", {}, h("span", {}, label), input, unit ? h("em", {}, unit) : null);
  return { element, get value() {
    const read = Number.parseFloat(input.value);
    const low = limits.min ?? -Infinity;
    return Number.isFinite(read) ? Math.min(limits.max ?? Infinity, Math.max(low, read)) : value;
  } };
}

export const fixed = (x, digits = 1) => (Number.isFinite(x) ? x.toFixed(digits) : "–");
export const grouped = (n) => (Number.isFinite(n) ? Math.round(n).toLocaleString("en").replaceAll(",", "\u202f") : "–");

/** Seconds as m:ss.t */
export function clockTime(s) {
  if (!Number.isFinite(s)) return "–";
  const minutes = Math.floor(s / 60);
  return `${minutes}:${(s - minutes * 60).toFixed(1).padStart(4, "0")}`;
}
