// Machine data in What if: a table drawn by hand, and sliders for the place of its reflector.

import { componentWords } from "./components.js";
import { el, fixed, redraw, short, signed, svg, units } from "./dom.js";

const WIDTH = 380, HEIGHT = 170, LEFT = 36, RIGHT = 8, TOP = 8, BOTTOM = 20;
const REACH_MM = 500, FREE = 1.4, SMALLEST = 5; // around a place; room above a curve; end of the scale at least
const state = { cards: [], changes: new Map(), name: null, end: SMALLEST, panel: null, onChange: () => {}, onEnd: () => {} };

// `onChange` is told when something was drawn or moved, `onEnd` when it is let go.
export function machineSection(panel, onChange, onEnd) {
  Object.assign(state, { panel, onChange, onEnd });
}

export function showMachine(cards, changes) {
  state.cards = cards;
  state.changes = new Map(changes.map((one) => [one.component, { ...one }]));
  if (!cards.some((card) => card.name === state.name)) state.name = cards[0]?.name ?? null;
  fitScale();
  draw();
}

export const machineChanges = () => [...state.changes.values()];

const card = () => state.cards.find((one) => one.name === state.name);
const offset = () => state.changes.get(state.name)?.offset ?? card().value.map(() => 0);
const place = () => state.changes.get(state.name)?.measured_at_mm ?? card().measured_at_mm;

function fitScale() {
  if (!card()) return;
  const most = Math.max(...card().value.map((v, k) => Math.max(Math.abs(v), Math.abs(v + offset()[k]))));
  const wanted = Math.max(SMALLEST, FREE * most), decade = 10 ** Math.floor(Math.log10(wanted));
  state.end = decade * [1, 2, 5, 10].find((n) => n * decade >= wanted);
}

function change(what) {
  state.changes.set(state.name, { component: state.name, ...state.changes.get(state.name), ...what });
  draw();
  state.onChange();
}

function draw() {
  if (!state.panel || !card()) return;
  const select = el("select", { "aria-label": "Component error", value: state.name }, state.cards.map((one) =>
    el("option", { value: one.name, selected: one.name === state.name }, `${one.name}${one.has_table ? "" : " (no table)"}${state.changes.has(one.name) ? " · changed" : ""}`)));
  select.onchange = ({ target }) => { state.name = target.value; fitScale(); draw(); };
  const back = el("button", { type: "button", disabled: !state.changes.has(state.name) }, "As it was");
  back.onclick = () => { state.onEnd(); state.changes.delete(state.name); fitScale(); draw(); state.onChange(); state.onEnd(); };
  redraw(state.panel, [el("div", { class: "row" }, select, el("span", { class: "soft" }, `${componentWords(card().name)}, ${units(card().unit)}`), el("span", { class: "spring" }), back),
    plot(), el("p", { class: "soft" }, "Draw over the curve, or take a point and press arrow up or down. The thin line is the machine's table."), ...places()]);
}

// ---- the table: what it is, and what was drawn

const x = (k) => LEFT + ((WIDTH - LEFT - RIGHT) * k) / (card().value.length - 1);
const y = (v) => TOP + (HEIGHT - TOP - BOTTOM) * (0.5 - v / (2 * state.end));

function plot() {
  const { value, position_mm, unit } = card(), now = value.map((v, k) => v + offset()[k]);
  const made = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "curve drawn", id: "drawn" });
  const text = (word, at, row, anchor) => Object.assign(svg("text", { class: "tick", x: at, y: row, "text-anchor": anchor }), { textContent: word });
  for (const share of [-1, -0.5, 0, 0.5, 1])
    made.append(svg("line", { class: "grid", x1: LEFT, x2: WIDTH - RIGHT, y1: y(share * state.end), y2: y(share * state.end) }), text(short(share * state.end), LEFT - 5, y(share * state.end) + 4, "end"));
  const half = (position_mm.length - 1) / 2;
  for (const [k, anchor] of [[0, "start"], [half, "middle"], [position_mm.length - 1, "end"]]) made.append(text(short(position_mm[k]), x(k), HEIGHT - 4, anchor));
  const line = (values, kind) => svg("polyline", { class: "line " + kind, points: values.map((v, k) => `${x(k)},${y(v)}`).join(" ") });
  made.append(line(value, "table"), line(now, "fitted"));
  now.forEach((v, k) => made.append(handle(k, v, `${card().name} at ${card().axis} ${fixed(position_mm[k], 0)} mm`, unit)));
  made.onpointerdown = press;
  made.onpointermove = sweep;
  made.onpointerup = () => { state.last = null; state.onEnd(); };
  return made;
}

function handle(k, v, word, unit) {
  const made = svg("circle", { class: "handle", cx: x(k), cy: y(v), r: 5.5, tabindex: 0, role: "slider", "aria-label": word, "aria-valuenow": v.toFixed(2),
    "aria-valuemin": -state.end, "aria-valuemax": state.end, "aria-valuetext": `${signed(v)} ${units(unit)}` });
  made.onkeydown = (event) => {
    const step = { ArrowUp: 1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
    if (!step) return;
    event.preventDefault();
    put([k], [v + (step * state.end) / 100]);
    state.onEnd();
  };
  return made;
}

// Set the curve at some of its places.
function put(places, values) {
  const own = card().value, next = [...offset()];
  places.forEach((k, i) => { next[k] = Number((Math.max(-state.end, Math.min(state.end, values[i])) - own[k]).toPrecision(6)); });
  change({ offset: next });
}

function under(event) {
  const box = event.currentTarget.getBoundingClientRect(), count = card().value.length;
  const across = ((event.clientX - box.left) / box.width) * WIDTH, down = ((event.clientY - box.top) / box.height) * HEIGHT;
  const k = Math.round(((across - LEFT) / (WIDTH - LEFT - RIGHT)) * (count - 1));
  return [Math.max(0, Math.min(count - 1, k)), 2 * state.end * (0.5 - (down - TOP) / (HEIGHT - TOP - BOTTOM))];
}

function press(event) {
  event.currentTarget.setPointerCapture(event.pointerId);
  state.last = under(event);
  put([state.last[0]], [state.last[1]]);
}

// A sweep passes every place between the last one and this one.
function sweep(event) {
  if (!event.buttons || !state.last) return;
  const [from, low] = state.last, [to, high] = state.last = under(event), step = Math.sign(to - from) || 1, places = [], values = [];
  for (let k = to; k !== from; k -= step) {
    places.push(k);
    values.push(low + ((high - low) * (k - from)) / (to - from));
  }
  put(places.length ? places : [to], places.length ? values : [high]);
}

// ---- where the reflector stood

function places() {
  const now = place(), own = card().measured_at_mm;
  if (!now) return [el("p", { class: "soft" }, card().unit === "urad" ? "An angle is the same wherever it is read." : "No place of the reflector is stated for this table.")];
  return [el("h4", {}, "Where the reflector stood"), ...now.map((at, k) => {
    const word = `${"XYZ"[k]} of the reflector`, text = el("output", {}, `${fixed(at, 0)} mm`);
    const input = el("input", { type: "range", min: own[k] - REACH_MM, max: own[k] + REACH_MM, step: 1, value: at, "aria-label": `${card().name} ${word}`, "aria-valuetext": `${fixed(at, 0)} mm` });
    input.oninput = ({ target }) => change({ measured_at_mm: place().map((v, i) => (i === k ? Number(target.value) : v)) });
    input.onchange = () => state.onEnd();
    return el("label", { class: "slider" }, el("span", {}, word), text, input, el("small", { class: "soft" }, `in the machine file ${fixed(own[k], 0)} mm`));
  })];
}
