// Diagnose: what the measurements say the model lacks, on cards with Add; the curve of the error.

import { attempt, bench, isAtWork } from "./bench.js";
import { downloadAddress, get, showAddress } from "./api.js";
import { el, fixed, micro, redraw, rounded, short, units } from "./dom.js";
import { historyCurve } from "./curve.js";
import { readingsForm } from "./readings.js";
import { runBox, startRun } from "./runs.js";
import { setLook } from "./stage.js";

const VERDICTS = {
  named: "The model lacks this",
  class: "The model lacks something that these readings narrow down to a class",
  some: "The model lacks these; of some these readings show no more than a class",
  partly: "The model lacks this, and something else remains",
  unknown: "Something real is left that no known effect clearly explains",
  nothing: "The measurements agree with the model: nothing is missing that they could show",
};
const ADDERS = ["rounds", "add"]; // they write jobs
const STATUS = { shown: "shown", class: "shown as a class" };
const MOST_BLIND = 6, EXCHANGED = "exchanged";
const state = { measured: null, trouble: null, isWhole: false };

export function diagnosePanel(panel) {
  const draw = state.draw = () => redraw(panel, parts());
  for (const kind of ["part", "run", "shown", "state"]) bench.on(kind, draw);
  bench.on("part", attempt(async () => {
    const { revision } = bench.state;
    Object.assign(state, { measured: null, trouble: null });
    draw();
    if (!bench.about.is_measured) return;
    try {
      const measured = await get("/api/measured");
      if (revision === bench.state.revision) state.measured = measured;
    } catch (error) {
      if (revision === bench.state.revision) state.trouble = error.message;
    }
    draw();
  }));
}

function parts() {
  if (!bench.about) return [];
  if (!bench.about.is_measured)
    return [el("p", { class: "soft" }, "Nothing was measured for this job. A diagnosis needs points of a CMM, or readings of an instrument."), readingsForm()];
  if (state.trouble) return [el("p", { class: "trouble", role: "alert" }, state.trouble), readingsForm()];
  const found = bench.state.shown?.diagnosis, busy = ["diagnose", ...ADDERS].some(isAtWork);
  const button = el("button", { type: "button", class: "primary", disabled: busy, id: "diagnose" }, found ? "Diagnose again" : "Diagnose");
  button.onclick = () => startRun("/api/diagnose");
  return [
    measuredLine(),
    el("div", { class: "row" }, button, found ? residualButtons() : el("span", { class: "soft" }, "asks which effect is missing")),
    runBox(ADDERS.find(isAtWork) ?? "diagnose", busy),
    historyCurve(),
    ...(found ? verdict(found) : []),
    found ? runBox(kindOf(found)) : null,
    found?.next_measurement ? null : readingsForm(),
  ];
}

// The kind of run that a verdict is of: a diagnosis, or rounds of adding, which end with one.
const kindOf = (found) => ((bench.state.runs ?? []).some((run) => run.number === found.run && run.kind === "rounds") ? "rounds" : "diagnose");

function measuredLine() {
  const m = state.measured;
  if (!m) return el("p", { class: "soft" }, "Reading the measurements …");
  return el("p", { class: "lead" }, el("b", { class: "big" }, fixed(m.rms_um), " ", el("small", {}, "µm RMS")),
    ` measured − predicted over ${m.readings} readings (${m.measurements.map((one) => one.name).join(", ")})`);
}

function residualButtons() {
  const button = el("button", { type: "button" }, "Show it on the part");
  button.onclick = () => setLook({ quantity: "residual" });
  return bench.about.has_measured_part ? button : null;
}

function verdict(found) {
  // a file that says something else than is true comes before anything that the machine lacks
  const isFirst = (note, i) => found.note_records?.[i]?.kind === EXCHANGED, isRest = (note, i) => !isFirst(note, i);
  const isOfSome = found.verdict === "class" && found.effects.some((one) => one.status === "shown");
  const rows = [
    ...found.notes.filter(isFirst).map((note) => el("p", { class: "trouble" }, "Look at the files first: ", micro(note))),
    el("h3", { class: "verdict " + found.verdict }, VERDICTS[isOfSome ? "some" : found.verdict]),
    rmsBars(found), ofMeasurement(found),
    ...found.effects.map((one) => card(one, found)), addAll(found),
  ];
  if (["partly", "unknown"].includes(found.verdict)) {
    rows.push(el("p", {}, "What remains beside noise: ", el("b", {}, fixed(found.remains_um)), " µm RMS",
      ...Object.entries(found.remains_by_um).map(([name, size], k) => `${k ? ", " : ": "}${name} ${fixed(size)}`), ". ",
      found.proposals.length ? "The tab Own law has forms for it." : ""));
    rows.push(...found.where_it_fails.slice(0, 3).map((one) => el("p", { class: "remark" }, micro(one.text))));
  }
  if (found.weak_effects.length)
    rows.push(el("p", { class: "soft" }, "Not counted as present: ", micro(found.weak_effects.map((w) => `${[w.effect, w.target].filter(Boolean).join(" ")} (${w.why})`).join("; "))));
  if (found.next_measurement) rows.push(next(found), readingsForm(found.next_measurement.text));
  rows.push(blindSpots(found), ...found.notes.filter(isRest).map((note) => el("p", { class: "remark" }, micro(note))));
  rows.push(whole(found));
  return rows;
}

// What the readings hold that the verdict counts as of the measurement.
function ofMeasurement({ of_measurement_um }) {
  const each = Object.entries(of_measurement_um).map(([name, um]) => `${name} ${short(um)} µm`);
  return each.length ? el("p", {}, `Counted as of the measurement: ${each.join(", ")}.`) : null;
}

// An effect that these readings cannot show may be there all the same.
function blindSpots({ blind_spots }) {
  const unseen = blind_spots.filter((spot) => spot.from_size !== null).slice(0, MOST_BLIND);
  if (!unseen.length) return null;
  return el("details", { class: "blind" }, el("summary", {}, "These measurements cannot show"),
    el("ul", {}, unseen.map((spot) => el("li", {}, `${[spot.effect, spot.target].filter(Boolean).join(" ")}: ${micro(spot.text)}`))));
}

function rmsBars(found) {
  const noise = bench.about.effects.length ? "noise, tables and what the job's effects leave open" : "noise and the tables' uncertainty";
  const words = { before: "the model as it is", after: "with what was found", expected_noise: noise };
  if (!found.effects.some((one) => one.effect !== "unknown")) delete words.after; // the same figure once more
  const largest = Math.max(...Object.values(found.rms_um), 1e-9);
  return el("table", { class: "bars" }, el("tbody", {}, Object.entries(words).filter(([key]) => key in found.rms_um).map(([key, word]) => {
    const bar = el("i", { class: key });
    bar.style.width = (100 * found.rms_um[key]) / largest + "%";
    return el("tr", {}, el("th", { scope: "row" }, word), el("td", { class: "bar" }, bar), el("td", { class: "value" }, fixed(found.rms_um[key]), " µm"));
  })));
}

function card(one, found) {
  if (one.effect === "unknown")
    return el("article", { class: "card open" }, el("h4", {}, "Not known"), el("p", {}, micro(one.where ?? "everywhere: more scatter than the uncertainty says")));
  const word = one.target ? `${one.effect}:${one.target}` : one.effect;
  const add = el("button", { type: "button", class: "primary", disabled: ADDERS.some(isAtWork) }, "Add");
  add.onclick = () => startRun("/api/add", { effects: [word] });
  const numbers = Object.entries(one.interval_95).map(([name, [low, high]]) => {
    const unit = units(unitOf(name)), [said, from, to] = rounded(one.parameters[name], [low, high]);
    return el("p", { class: "size" }, el("b", {}, said), ` ${unit} `,
      el("small", { class: "soft" }, one.weakly_identified.includes(name) ? `${meaning(one, name)}: the readings hardly show it` : `${meaning(one, name)}: ${from} to ${to} (95 %)`));
  });
  const rivals = (one.rivals ?? []).filter((label) => label !== [one.effect, one.target].filter(Boolean).join(" "));
  return el("article", { class: "card" },
    el("header", {}, el("h4", {}, one.title ?? one.what, " ", el("code", {}, word.replace(":", " "))), add),
    one.where ? el("p", {}, micro(one.where)) : null, one.remark ? el("p", { class: "soft" }, one.remark) : null, ...numbers,
    el("p", { class: "soft" }, `${STATUS[one.status] ?? one.status}, ${fixed(one.size_um)} µm RMS of these readings, ${Math.round(100 * one.share)} % of all found or left (log odds ${Math.round(one.log_odds)})`),
    rivals.length ? el("p", {}, "Cannot be told from: ", rivals.join(", ")) : null,
    rivals.length && !found.next_measurement ? el("p", { class: "soft" }, "None of the tests that vmach can plan tells them apart.") : null,
    details([["Usual size", one.usual_size], ["Confirm", one.confirm], ["Cure", one.cure]]));
}

// All that is shown into one job; or round by round, each with a diagnosis of the job before.
function addAll(found) {
  const words = found.effects.filter((e) => e.effect !== "unknown").map((e) => (e.target ? `${e.effect}:${e.target}` : e.effect));
  if (!words.length) return null;
  const disabled = ADDERS.some(isAtWork), all = el("button", { type: "button", disabled }, `Add all ${words.length}`);
  const rounds = el("button", { type: "button", disabled, id: "rounds" }, "Add all in rounds");
  all.onclick = () => startRun("/api/add", { effects: words });
  rounds.onclick = () => startRun("/api/add-in-rounds");
  return el("div", { class: "row" }, words.length > 1 ? all : null, rounds,
    el("span", { class: "soft" }, "adds what is shown, diagnoses again, and goes on until nothing further is shown"));
}

function meaning({ effect }, name) {
  const known = bench.cards.find((one) => one.effect === effect)?.parameters.find((one) => one.name === name);
  return known ? micro(known.meaning) : wordsOf(name);
}

const unitOf = (name) => (name.match(/_((?:um|mm|urad|rad|ppm|s|ms|ms2|deg|degc|n)(?:_per_\w+)?)$/i) ?? ["", ""])[1];
const wordsOf = (name) => (unitOf(name) ? name.slice(0, -unitOf(name).length - 1) : name).replaceAll("_", " ");

function details(rows) {
  const known = rows.filter(([, text]) => text);
  if (!known.length) return null;
  return el("details", {}, el("summary", {}, "How to confirm and cure it"),
    el("dl", { class: "facts" }, known.map(([word, text]) => el("div", {}, el("dt", {}, word), el("dd", {}, micro(text))))));
}

function next(found) {
  return el("article", { class: "card next" }, el("h4", {}, "Measure next"), el("p", {}, micro(found.next_measurement.text)),
    found.program ? el("p", {}, el("a", { href: downloadAddress(found.program), download: "" }, "Download its NC program")) : null,
    found.program ? el("p", { class: "soft" }, "Drop its readings below.") : null);
}

function whole(found) {
  const toggle = el("button", { type: "button", "aria-expanded": String(state.isWhole) }, "All plots");
  toggle.onclick = () => { state.isWhole = !state.isWhole; state.draw(); };
  const address = `${showAddress(found.page)}?run=${found.run}`; // another diagnosis is another page
  const frame = state.isWhole ? el("iframe", { title: "The whole diagnosis", class: "whole", id: "whole-" + found.run, sandbox: "allow-scripts", src: address }) : null;
  return el("section", {}, el("div", { class: "row" }, toggle,
    el("a", { href: showAddress(found.page), target: "_blank", rel: "noopener" }, "open"),
    el("a", { href: downloadAddress(found.page), download: "" }, "download")), frame);
}
