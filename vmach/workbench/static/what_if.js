// What if: a card for every effect, with sliders; the part follows them at once.

import { attempt, bench } from "./bench.js";
import { framed, get, postFramed, TAB } from "./api.js";
import { el, fixed, redraw, short, units } from "./dom.js";
import { runBox, startRun } from "./runs.js";
import { machineChanges, machineSection, showMachine } from "./machine_data.js";
import { applyValues, stage } from "./stage.js";

const state = { cards: [], machine: [], values: new Map(), gesture: 1, movedBy: 1, moves: 0, isWaiting: false, isDirty: false, isHeld: false, panel: null, open: new Set() };
const STEPS = 200, SETTLED_MS = 700;
const keyOf = (card) => card.effect + ":" + card.target;

export function whatIfPanel(panel) {
  state.panel = panel;
  const filter = el("input", { type: "search", placeholder: "Find an effect", "aria-label": "Find an effect" });
  const reset = el("button", { type: "button", class: "reset" }, "Reset");
  reset.onclick = () => { nextGesture(); showMachine(state.machine, []); change(new Map()); nextGesture(); };
  const keep = el("button", { type: "button", id: "keep", title: "Write a job beside this one that has these values" }, "Keep as a job");
  keep.onclick = () => startRun("/api/keep");
  const machine = el("div", { class: "machine" }), kept = el("div", { class: "kept" });
  machineSection(machine, moved, nextGesture);
  const list = el("div", { class: "cards" });
  panel.append(
    el("div", { class: "row" }, filter, reset, keep),
    el("div", {}, el("p", { class: "residual", id: "what-if-residual", role: "status" }), el("p", { class: "residual soft", id: "what-if-exact" })), kept,
    el("details", { class: "effect", id: "machine-data" }, el("summary", {}, el("b", {}, "Machine data: tables, reflectors")), machine), list);
  filter.oninput = () => showCards(list, filter.value.toLowerCase());
  bench.on("part", attempt(async () => {
    const { moves } = state, { revision } = bench.state, found = await get("/api/effects");
    if (revision !== bench.state.revision) return; // of a job that is open no more
    ({ cards: state.cards, machine: state.machine } = found);
    bench.cards = state.cards;
    if (moves === state.moves) readChanges(bench.state.changes);
    else showMachine(state.machine, machineChanges()); // what was moved meanwhile stays
    showCards(list, filter.value.toLowerCase());
    showResidual(null);
    if (changesNow().length) await push(); // of sliders that stand already
  }));
  bench.on("changes", attempt(async ({ changes, tab }) => {
    if (tab === TAB) return;
    readChanges(changes);
    showCards(list, filter.value.toLowerCase());
    await push(); // colours and RMS of what the server knows already
  }));
  bench.on("run", () => redraw(kept, [runBox("keep")]));
  state.redraw = () => showCards(list, filter.value.toLowerCase());
}

function readChanges(changes) {
  const ofMachine = (changes ?? []).filter((one) => one.component);
  showMachine(state.machine, ofMachine);
  state.values = new Map((changes ?? []).filter((one) => !one.component).map((one) => [one.effect + ":" + (one.target ?? ""), { ...one.parameters }]));
}

// One card an effect, with the sliders of all its targets; those that were moved come first.
function showCards(list, wanted) {
  const groups = new Map();
  for (const card of state.cards) {
    if (wanted && !`${card.effect} ${card.target} ${card.title}`.toLowerCase().includes(wanted)) continue;
    if (!groups.has(card.effect)) groups.set(card.effect, []);
    groups.get(card.effect).push(card);
  }
  const rank = (cards) => (cards.some((c) => state.values.has(keyOf(c))) ? 0 : cards.some((c) => c.in_job) ? 1 : 2);
  const sorted = [...groups.values()].map((cards, i) => [rank(cards), i, cards]).sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  redraw(list, sorted.length ? sorted.map((entry) => cardOf(entry[2], Boolean(wanted) && sorted.length < 4))
    : [el("p", { class: "soft" }, "No effect of this name.")]);
}

function cardOf(cards, isOpen) {
  const [{ effect, title, usual_size }] = cards, touched = cards.filter((card) => state.values.has(keyOf(card)));
  const targets = cards.map((card) => card.target).filter(Boolean), inJob = cards.filter((card) => card.in_job);
  const head = el("summary", {}, el("b", {}, title),
    el("span", { class: "soft" }, targets.length > 4 ? `${targets.length} targets` : targets.join(" ")),
    inJob.length ? el("span", { class: "tag" }, ["in the job", ...inJob.map((card) => card.target)].join(" ").trim()) : null,
    touched.length ? el("span", { class: "tag moved" }, ["moved", ...touched.map((card) => card.target)].join(" ").trim()) : null);
  const made = el("details", { class: "effect", open: isOpen || touched.length > 0 || state.open.has(effect) }, head,
    cards.map((card) => el("section", { class: "target" }, targets.length ? el("h4", {}, card.target) : null,
      card.parameters.length ? card.parameters.map((p) => sliderOf(card, p)) : el("p", { class: "soft" }, "A correction curve; it has no slider."))),
    el("p", { class: "soft" }, usual_size ? "Usual: " + usual_size.replace(/\bum\b/g, "µm") : ""));
  made.ontoggle = ({ target }) => (target.open ? state.open.add(effect) : state.open.delete(effect));
  return made;
}

function sliderOf(card, p) {
  const key = keyOf(card), now = state.values.get(key)?.[p.name] ?? p.value;
  const unit = units(p.unit), text = el("output", {});
  const toShare = (v) => (p.is_logarithmic ? Math.log(v / p.low) / Math.log(p.high / p.low) : (v - p.low) / (p.high - p.low || 1));
  const toValue = (s) => (p.is_logarithmic ? p.low * (p.high / p.low) ** s : p.low + s * (p.high - p.low));
  const input = el("input", { type: "range", min: 0, max: STEPS, value: Math.round(STEPS * toShare(now)), "aria-label": `${card.effect} ${card.target} ${p.meaning}` });
  const show = (v, range, output) => {
    output.textContent = `${short(v)} ${unit}`;
    range.setAttribute("aria-valuetext", output.textContent);
  };
  show(now, input, text);
  input.onchange = nextGesture;
  input.oninput = ({ target }) => {
    state.isHeld = true;
    let value = toValue(Number(target.value) / STEPS);
    if (p.is_amplitude && Math.abs(value) < (p.high - p.low) / STEPS / 2) value = 0;
    value = Number(value.toPrecision(4));
    show(value, target, target.parentNode.querySelector("output"));
    // what has a size is seen at once: its other parameters stay as they are usual
    const own = { ...Object.fromEntries(card.parameters.map((q) => [q.name, q.value])), ...state.values.get(key), [p.name]: value };
    change(new Map(state.values).set(key, own), false);
  };
  const interval = p.half_width ? `in the job ${short(p.value)} ± ${short(p.half_width)} ${unit} (95 %)` : card.in_job ? `in the job ${short(p.value)} ${unit}` : "";
  return el("label", { class: "slider" }, el("span", {}, p.meaning.replace(/\bum\b/g, "µm")), text, input, interval ? el("small", { class: "soft" }, interval) : null);
}

// A slider is let go: what is moved next is another step to undo.
function nextGesture() {
  state.gesture += 1;
  state.isHeld = false;
  if (!state.isWaiting) cutAnewSoon();
}

// ---- to the server: one question at a time, the last position always gets there

function change(values, isRedrawn = true) {
  state.values = values;
  if (isRedrawn) state.redraw();
  moved();
}

function moved() {
  state.moves += 1;
  state.movedBy = state.gesture;
  push();
}

const push = attempt(async () => {
  stage.scene?.stir();
  if (state.isWaiting) {
    state.isDirty = true;
    return;
  }
  state.isWaiting = true;
  document.getElementById("what-if-exact").textContent = "";
  try {
    do {
      state.isDirty = false;
      const [figures, values] = await postFramed("/api/what-if", { changes: changesNow(), shown: bench.look, tab: TAB, gesture: state.movedBy });
      if (figures.quantity === bench.look.quantity && figures.model === bench.look.model) applyValues(figures, values);
      showResidual(figures.residual_rms_um);
    } while (state.isDirty);
  } finally {
    state.isWaiting = false;
  }
  cutAnewSoon();
});

// When the sliders are let go and rest, the part is cut anew: another move may make a point then. That takes the
// model a while, in which it would answer no slider.
function cutAnewSoon() {
  clearTimeout(state.settling);
  if (!state.isHeld && changesNow().length && bench.look.quantity === "deviation" && bench.look.model === "abbe")
    state.settling = setTimeout(cutAnew, SETTLED_MS);
}

const cutAnew = attempt(async () => {
  const asked = JSON.stringify(changesNow());
  const [figures, values] = await framed("/api/exact");
  if (state.isWaiting || asked !== JSON.stringify(changesNow()) || bench.look.quantity !== "deviation") return;
  applyValues(figures, values);
  document.getElementById("what-if-exact").textContent = figures.first_order_off_um >= 0.05
    ? `Cut anew: up to ${fixed(figures.first_order_off_um)} µm from what the sliders showed.` : "Cut anew: the same.";
});

function changesNow() {
  const ofEffects = [...state.values].map(([key, parameters]) => {
    const [effect, target] = key.split(":");
    return { effect, target, parameters };
  });
  return [...ofEffects, ...machineChanges()];
}

function showResidual(um) {
  const line = document.getElementById("what-if-residual");
  const count = changesNow().length;
  document.getElementById("keep").disabled = !count;
  if (!count) line.textContent = "Move a slider: the part is coloured anew at once. The job stays as it is.";
  else if (um === null || um === undefined) line.textContent = `${count} ${count === 1 ? "thing" : "things"} moved.`;
  else line.textContent = `RMS of measured − predicted with the sliders: ${fixed(um)} µm`;
}


