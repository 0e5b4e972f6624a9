// The part: colours, scale, worst places, the point that was clicked.

import { attempt, bench, notice } from "./bench.js";
import { bytes, framed, get, query, Refused } from "./api.js";
import { byId, el, fixed, short, signed } from "./dom.js";
import { componentWords } from "./components.js";
import { Overlay } from "./overlay.js";

export const MODEL_WORDS = { abbe: "Abbe", htm: "HTM", none: "Program alone" };
const VIEW_WORDS = { overview: "Overview", top: "Top", front: "Front", right: "Right", back: "Back", below: "Below" };

export const stage = { scene: null, scenes: [], overlay: null, toleranceUm: 10, rangeUm: 1, followers: [], noPicture: null, shownLook: null };
const FIRST_LOOK = { quantity: "deviation", model: "abbe" };
let asked = 0, loaded = 0;

// ---- the mesh of a job, once; the colours as often as anything changes

export async function loadPart() {
  byId("veil").textContent = "Machining the part in the model …";
  byId("veil").hidden = false;
  const number = ++loaded, model = new Model(await unpackPayload(await bytes("/api/mesh")));
  if (number !== loaded) return; // another part was asked for since
  if (stage.scene) stage.scene.load(model);
  else tryScene(model);
  if (stage.scene) showSection();
  await loadFirstValues();
}

// What is chosen may not be had of this part, as where a measured file cannot be read: then its deviation is shown.
async function loadFirstValues() {
  stage.shownLook = null;
  try {
    await loadValues();
  } catch (error) {
    if (bench.look.quantity === FIRST_LOOK.quantity) throw error;
    notice(error.message, "error", "look");
    showLook(FIRST_LOOK);
    await loadValues();
  }
}

// Without WebGL 2 there are figures and all that can be done, and no picture.
function tryScene(model) {
  try {
    makeScene(model);
  } catch (error) {
    stage.noPicture = `The part is not drawn: ${error.message}. Figures and tabs work without it.`;
  }
}

// What is done on the picture of the part needs one.
export function needPicture() {
  if (!stage.scene) throw new Refused(stage.noPicture ?? "No part is there yet; open a job that can be read.");
  return stage.scene;
}

function makeScene(model) {
  const canvas = byId("canvas");
  stage.scene = new Scene(canvas, model, bench.state.colour_stops, bench.state.unknown_colour);
  stage.overlay = new Overlay(stage.scene);
  stage.scene.onDraw = () => { placeMarks(); stage.followers.forEach((follow) => follow()); };
  stage.scene.onSettle = hideCovered;
  stage.scenes = [stage.scene];
  listenToGestures(canvas, stage.together, (x, y) => pickAt(x, y));
}

// What turns one view turns all of them.
stage.together = Object.fromEntries(["orbit", "pan", "zoomAt", "home"].map(
  (name) => [name, (...values) => stage.scenes.forEach((scene) => scene[name](...values))]));

export async function loadValues() {
  const number = ++asked, look = { ...bench.look };
  markOld(true);
  try {
    const [figures, values] = await framed("/api/values?" + query({ ...look, tolerance_um: stage.toleranceUm || null }));
    if (number !== asked) return;
    stage.shownLook = look;
    applyValues(figures, values);
  } catch (error) {
    if (number !== asked) return;
    if (stage.shownLook) showLook(stage.shownLook); // the choice says what is seen
    throw error;
  } finally {
    if (number === asked) markOld(false);
  }
}

// While something else was chosen than what is seen, the map is pale.
function markOld(isOld) {
  document.querySelector(".stage").classList.toggle("old", isOld);
}

// (value, known) of each vertex, as the viewer takes it.
export function pairsOf(values) {
  const pairs = new Float32Array(2 * values.length);
  for (let i = 0; i < values.length; i++)
    if (values[i] === values[i]) { pairs[2 * i] = values[i]; pairs[2 * i + 1] = 1; }
  return pairs;
}

// Figures and values (um, NaN unknown) of every vertex, from wherever they come.
export function applyValues(figures, values) {
  const pairs = pairsOf(values), isNew = bench.figures?.quantity !== figures.quantity;
  bench.figures = figures;
  stage.scene?.setValues(pairs);
  if (isNew) byId("range").value = 50;
  showScale();
  showFigures();
  makeMarks();
  bench.tell("figures", figures);
}

// ---- choices above the part

export function showChoices() {
  const groups = { "": [], "Share of one error": [] };
  for (const one of bench.about.quantities)
    groups[one.name.startsWith("share:") ? "Share of one error" : ""].push(el("option", { value: one.name }, choiceWord(one)));
  byId("quantity").replaceChildren(...groups[""], el("optgroup", { label: "Share of one error" }, groups["Share of one error"]));
  if (!bench.about.quantities.some((one) => one.name === bench.look.quantity)) bench.look.quantity = "deviation";
  byId("quantity").value = bench.look.quantity;
  byId("models").replaceChildren(...bench.about.models.map((name) => {
    const input = el("input", { type: "radio", name: "model", value: name, checked: name === bench.look.model });
    input.onchange = () => setLook({ model: name });
    return el("label", {}, input, el("span", {}, MODEL_WORDS[name]));
  }));
  showModels();
}

function choiceWord({ name, label }) {
  if (!name.startsWith("share:")) return label;
  const source = label.replace("Share of ", "");
  return [source, componentWords(source)].filter(Boolean).join(" – ");
}

function showModels() {
  byId("models").hidden = !bench.about.quantities.find((one) => one.name === bench.look.quantity)?.has_models;
}

export const setLook = attempt(async (change) => {
  showLook(change);
  await loadValues();
});

function showLook(look) {
  Object.assign(bench.look, look);
  byId("quantity").value = bench.look.quantity;
  for (const input of byId("models").querySelectorAll("input")) input.checked = input.value === bench.look.model;
  showModels();
}

export function listenToControls() {
  byId("quantity").onchange = (event) => setLook({ quantity: event.target.value });
  byId("views").append(...Object.entries(VIEW_WORDS).map(([name, word]) => {
    const button = el("button", { type: "button" }, word);
    button.onclick = () => stage.together.home(...VIEWS[name]);
    return button;
  }));
  let waiting = null;
  byId("tolerance").oninput = () => {
    if (!stage.ownTolerance) return; // no job yet
    const at = Number(byId("tolerance").value) / 100;
    stage.toleranceUm = Number((stage.ownTolerance * 10 ** (2 * (at - 0.5))).toPrecision(2));
    showTolerance();
    clearTimeout(waiting);
    waiting = setTimeout(attempt(loadValues), 120);
  };
  byId("grey").onchange = showGrey;
  byId("marks-on").onchange = makeMarks;
  byId("range").oninput = showScale;
  for (const id of ["section", "section-at"]) byId(id).oninput = showSection;
  document.addEventListener("pointerdown", (event) => {
    const options = document.querySelector(".options[open]");
    if (options && !options.contains(event.target)) options.open = false;
  });
  document.querySelector(".options").addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !event.currentTarget.open) return;
    event.currentTarget.open = false;
    event.currentTarget.querySelector("summary").focus();
  });
}

export function setTolerance(um) {
  stage.ownTolerance = stage.toleranceUm = um;
  byId("tolerance").value = 50;
  showTolerance();
}

function showTolerance() {
  byId("tolerance-text").textContent = short(stage.toleranceUm) + " µm";
  byId("tolerance").setAttribute("aria-valuetext", byId("tolerance-text").textContent);
  stage.scene?.setLook({ tolerance: stage.toleranceUm });
}

// A size is no deviation: none of it is within a tolerance.
function showGrey() {
  stage.scene?.setLook({ greyWithin: byId("grey").checked && isSigned() });
}

function showSection() {
  const axis = byId("section").value, { scene } = stage;
  byId("section-at").hidden = axis === "";
  if (!scene) return;
  if (axis === "") return scene.setLook({ section: [0, 0, 0, 0] });
  const k = Number(axis), share = Number(byId("section-at").value) / 100, normal = [0, 0, 0];
  normal[k] = 1;
  scene.setLook({ section: [...normal, scene.model.low[k] + share * (scene.model.high[k] - scene.model.low[k]) + 1e-3] });
}

// ---- scale and figures

// Whether what is shown has a direction; an uncertainty has none.
export function isSigned() {
  const { quantity, isOfTwo } = bench.figures ?? {};
  return Boolean(isOfTwo) || bench.about?.quantities.find((one) => one.name === quantity)?.is_signed !== false;
}

function showScale() {
  document.querySelector("#view .scale").hidden = Boolean(bench.about?.missing);
  if (!bench.figures) return;
  const { range_um } = bench.figures, at = Number(byId("range").value);
  const end = stage.rangeUm = Number((range_um * 10 ** ((at - 50) / 50)).toPrecision(2));
  const hasSign = isSigned(), shares = hasSign ? [1, 0.5, 0, -0.5, -1] : [1, 0.75, 0.5, 0.25, 0];
  byId("range-text").textContent = (hasSign ? "± " : "") + short(end) + " µm";
  byId("range").setAttribute("aria-valuetext", byId("range-text").textContent);
  byId("ramp").classList.toggle("sizes", !hasSign);
  byId("ticks").replaceChildren(...shares.map((share) => {
    const tick = el("li", {}, share === 0 ? "0" : (hasSign && share > 0 ? "+" : "") + short(share * end) + (share === 1 ? " µm" : ""));
    tick.style.top = (hasSign ? 50 - 50 * share : 100 - 100 * share) + "%";
    return tick;
  }));
  stage.scenes.forEach((scene) => scene.setLook({ range: end, tolerance: stage.toleranceUm }));
  showGrey();
}

function showFigures() {
  if (bench.about?.missing) // there is nothing that figures could be of
    return byId("figures").replaceChildren(el("div", { class: "missing" }, el("dt", {}, bench.about.missing)));
  const f = bench.figures, hasSign = isSigned(), number = hasSign ? signed : fixed;
  const title = hasSign ? "+ material is left on, − too much is cut off" : null;
  const entry = (word, value, unit = "µm") => el("div", { title }, el("dt", {}, word), el("dd", {}, value, " ", el("small", {}, unit)));
  const rows = [
    entry("RMS", fixed(f.rms_um)), entry("Mean", number(f.mean_um)),
    entry("Highest", number(f.high_um)), entry("Lowest", number(f.low_um)),
    ...(hasSign ? [entry(`Beyond ± ${short(stage.toleranceUm)} µm`, fixed(100 * f.outside, 1), "%")] : []),
    entry(f.points === "measured" ? "Measured" : "Points", f.count.toLocaleString("en").replaceAll(",", " "), ""),
  ];
  byId("figures").replaceChildren(...rows);
}

// ---- marks over the part

export function makeMarks() {
  const { scene } = stage;
  if (!scene || !bench.figures) return;
  const worst = byId("marks-on").checked && bench.look.quantity !== "uncertainty" ? bench.figures.worst : [];
  const marks = worst.map((point, i) => Object.assign(el("div", { class: "mark" }, String(i + 1)), { point }));
  if (bench.point) marks.unshift(Object.assign(el("div", { class: "mark dot" }),
    { point: { at: bench.point.at_mm, normal: bench.point.normal } }));
  byId("marks").replaceChildren(...marks);
  placeMarks();
  hideCovered();
}

function placeMarks() {
  const { scene } = stage, towards = scene.axes()[2], { section } = scene.look;
  for (const mark of byId("marks").children) {
    const [x, y] = scene.toScreen(mark.point.at);
    mark.style.transform = `translate(${x}px, ${y}px)`;
    const isThere = dot(mark.point.at, section) <= section[3] && dot(towards, mark.point.normal) > 0.02;
    mark.style.visibility = isThere ? "" : "hidden";
  }
  const turned = triad(scene);
  if (turned !== stage.turned) byId("triad").innerHTML = stage.turned = turned;
}

function hideCovered() {
  for (const mark of byId("marks").children)
    if (!stage.scene.sees(mark.point.at)) mark.style.visibility = "hidden";
}

// ---- a click names the point

export const pickAt = attempt(async (x, y) => {
  const hit = stage.scene.pick(x, y);
  if (!hit) return showPoint(null);
  await pickNear(hit.place, hit.normal);
});

export const pickNear = attempt(async (place, normal) => {
  const [px, py, pz] = place, [i, j, k] = normal;
  const found = await get("/api/point?" + query({ points: bench.figures.points, x: px, y: py, z: pz, i, j, k }));
  showPoint(found.id === undefined ? null : found);
});

export function showPoint(point) {
  bench.point = point;
  makeMarks();
  bench.tell("point", point);
}

export function faceWorst(place) {
  stage.scene?.face(place);
  return pickNear(place.at, place.normal);
}
