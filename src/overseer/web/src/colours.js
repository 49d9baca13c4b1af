// Colours of hosts. The first eight stay apart for every common kind of colour blindness, on a dark ground and in
// lightness too (after Okabe and Ito, lightened); further hosts walk round the wheel by the golden angle.

const FIRST = ["#4cb4ff", "#ffb02e", "#2fd6a3", "#ff6f91", "#b794ff", "#f4e666", "#ff8652", "#7fe3f5"];

const cache = new Map();

/** @param {number} host @returns {string} "#rrggbb" */
export function colourOfHost(host) {
  if (host < FIRST.length) return FIRST[host];
  if (!cache.has(host)) {
    const hue = (host * 137.508) % 360;
    const light = [0.68, 0.58, 0.76][host % 3];
    cache.set(host, hex(fromHsl(hue, 0.72, light)));
  }
  return cache.get(host);
}

/** @param {string} colour @returns {[number, number, number]} 0 to 1, as displayed */
export function channels(colour) {
  const value = Number.parseInt(colour.slice(1), 16);
  return [(value >> 16) / 255, ((value >> 8) & 255) / 255, (value & 255) / 255];
}

/** Asleep: half of the way to a darker grey. The hue still tells the host. */
export function asleep([r, g, b]) {
  const grey = (0.3 * r + 0.59 * g + 0.11 * b) * 0.8;
  const mix = (c) => c * 0.5 + grey * 0.5;
  return [mix(r), mix(g), mix(b)];
}

function fromHsl(hue, saturation, light) {
  const a = saturation * Math.min(light, 1 - light);
  return [0, 8, 4].map((n) => {
    const k = (n + hue / 30) % 12;
    return light - a * Math.max(-1, Math.min(k - 3, 9 - k, 1));
  });
}

function hex(rgb) {
  return `#${rgb.map((c) => Math.round(c * 255).toString(16).padStart(2, "0")).join("")}`;
}
