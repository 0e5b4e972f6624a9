// Elements, and numbers as people write and read them.

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
  made.given = properties;
  made.append(...present(children));
  return made;
}

const present = (children) => children.flat().filter((child) => child !== null && child !== undefined && child !== false);

// Make these the children of a node, and keep the nodes that are alike: a press of a button, the focus and a
// text that is being written outlive the news that come meanwhile. A node with `isKept` is never changed.
export function redraw(parent, children) {
  const wanted = present(children);
  wanted.forEach((one, i) => {
    const made = typeof one === "string" ? document.createTextNode(one) : one, there = parent.childNodes[i];
    if (there === made) return;
    if (there && isAlike(there, made)) become(there, made);
    else parent.insertBefore(made, there ?? null);
  });
  while (parent.childNodes.length > wanted.length) parent.lastChild.remove();
}

const isAlike = (there, made) => there.nodeName === made.nodeName && there.id === made.id && !there.isKept && !made.isKept;
const HANDLERS = ["onclick", "onchange", "oninput", "ontoggle", "onkeydown", "onpointerdown", "onpointermove", "onpointerup"];
const CHOSEN = ["value", "checked", "selected", "open"]; // what people change as well as the page

function become(there, made) {
  if (made.nodeType === Node.TEXT_NODE) {
    if (there.data !== made.data) there.data = made.data;
    return;
  }
  for (const { name } of [...there.attributes]) if (name !== "open" && name !== "style" && !made.hasAttribute(name)) there.removeAttribute(name);
  for (const { name, value } of made.attributes)
    if (name !== "open" && name !== "style" && there.getAttribute(name) !== value) there.setAttribute(name, value);
  if (there.style.cssText !== made.style.cssText) there.style.cssText = made.style.cssText;
  for (const name of HANDLERS) there[name] = made[name];
  redraw(there, [...made.childNodes]);
  for (const name of CHOSEN)
    if (made.given && name in made.given && !("data-free" in made.given) && there[name] !== made[name]) there[name] = made[name];
  there.given = made.given;
}

const SVG = "http://www.w3.org/2000/svg";
export function svg(tag, attributes = {}, ...children) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

// ---- what people write: a decimal point, or a decimal comma

const NUMBER = /^[+\-−]?(\d+[.,]?\d*|[.,]\d+)(e[+-]?\d+)?$/i;
const valueOf = (text) => (NUMBER.test(text) ? Number(text.replace("−", "-").replace(",", ".")) : NaN);

const THOUSANDS = /^[+\-−]?[1-9]\d{0,2}(,\d{3})+$/; // 1,500 may be either

export function oneNumber(text, what) {
  const value = valueOf(text.trim());
  if (THOUSANDS.test(text.trim()))
    throw new Error(`${what}: ${text.trim()} may be ${text.trim().replaceAll(",", "")} or ${value}; accepted: a decimal point, or no comma`);
  if (Number.isFinite(value)) return value;
  throw new Error(`${what}: ${text.trim() || "nothing"}; accepted: one number, such as 1.5`);
}

// Three numbers between blanks, semicolons or commas; a comma is a decimal one where the numbers are apart without it.
export function threeNumbers(text, what) {
  const apart = text.trim().split(/\s*;\s*|\s*,\s+|\s+/), plain = text.trim().split(",");
  const values = (apart.length === 1 && plain.length === 3 ? plain : apart).map(valueOf);
  if (values.length === 3 && values.every(Number.isFinite)) return values;
  throw new Error(`${what}: ${text.trim()}; accepted: three numbers, such as 1.5, 20, -3`);
}

// ---- what people read

const minus = (text) => text.replace("-", "−");
export const fixed = (value, digits = 2) => minus(value.toFixed(digits));
export const signed = (value, digits = 2) => {
  const text = Math.abs(value).toFixed(digits);
  return (Number(text) === 0 ? "" : value < 0 ? "−" : "+") + text;
};
// A value and the ends of its interval: two digits of the interval's half width count, as in the command's words.
export function rounded(value, [low, high]) {
  let half = Math.max(0.5 * (high - low), 1e-3 * Math.abs(value), 1e-12);
  half = Math.min(half, 3 * Math.abs(value) || half);
  const digits = 1 - Math.floor(Math.log10(half)), unit = 10 ** digits;
  return [value, low, high].map((v) => fixed(Math.round(v * unit) / unit, Math.min(Math.max(digits, 0), 12)));
}
export const short = (value) => minus(String(Number(value.toPrecision(3))));
export const uncertain = (u) => String(Number(u.toPrecision(2)));
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
  button.onclick = async ({ currentTarget }) => {
    await navigator.clipboard?.writeText(text).catch(() => {});
    currentTarget.textContent = "copied";
    setTimeout(() => { currentTarget.textContent = "copy"; }, 1200);
  };
  return el("div", { class: "command" }, el("code", {}, text), button);
}

// Names of jobs for people: the end of each path, as long as it takes to tell it from the others.
export function shortNames(paths) {
  const end = (path, count) => path.split("/").slice(-count).join("/");
  return new Map(paths.map((path) => {
    let count = 2;
    while (count < path.split("/").length && paths.some((one) => one !== path && end(one, count) === end(path, count))) count++;
    return [path, end(path, count)];
  }));
}
