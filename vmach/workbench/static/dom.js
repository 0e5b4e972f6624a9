// Elements, and numbers as people write them.

export const byId = (id) => document.getElementById(id);

// An element with properties, event listeners (onclick ...) and children; null children are left out.
export function el(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null) continue;
    if (name === "class") made.className = value;
    else if (name in made && !name.startsWith("aria")) made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return made;
}

const SVG = "http://www.w3.org/2000/svg";
export function svg(tag, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

const minus = (text) => text.replace("-", "−");
export const fixed = (value, digits = 2) => minus(value.toFixed(digits));
export const signed = (value, digits = 2) => {
  const text = Math.abs(value).toFixed(digits);
  return (Number(text) === 0 ? "" : value < 0 ? "−" : "+") + text;
};
export const short = (value) => minus(String(Number(value.toPrecision(3))));
export const units = (word) => ({ um: "µm", um_per_m: "µm/m", urad: "µrad", ppm: "ppm", mm: "mm", s: "s", ms: "ms", rad: "rad", degc: "°C" })[word.toLowerCase()] ?? word.replaceAll("_", " ").replace("um", "µm");
export const micro = (text) => text.replace(/\b(\d[\d.]*\s?)u(m|rad)\b/g, "$1µ$2").replace(/\bum\b/g, "µm").replace(/\burad\b/g, "µrad");
export const clock = (seconds) => {
  const whole = Math.floor(seconds), pad = (n) => String(n).padStart(2, "0");
  const [h, m, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  return (h ? h + ":" + pad(m) : String(m)) + ":" + pad(s);
};

// Long commands are shown as they can be typed; a click copies.
export function commandLine(text) {
  const button = el("button", { class: "copy", title: "Copy", type: "button" }, "copy");
  button.onclick = async () => {
    await navigator.clipboard?.writeText(text).catch(() => {});
    button.textContent = "copied";
    setTimeout(() => { button.textContent = "copy"; }, 1200);
  };
  return el("div", { class: "command" }, el("code", {}, text), button);
}
