// Look: the point that was clicked with the share of every error, the worst places, the features.

import { showAddress } from "./api.js";
import { bench } from "./bench.js";
import { componentWords } from "./components.js";
import { clock, el, fixed, micro, redraw, signed } from "./dom.js";
import { faceWorst, isSigned, MODEL_WORDS } from "./stage.js";

const MOST_SHARES = 12;

export function lookPanel(panel) {
  const point = el("section", { class: "point" }), worst = el("section"), features = el("section"), notes = el("section");
  panel.append(point, worst, features, notes);
  const empty = () => redraw(point, [el("h3", {}, "A point"),
    el("p", { class: "soft" }, "Click on the part: the point, the line and tool that made it, and the share of every error.")]);
  bench.on("part", () => { empty(); showNotes(notes); });
  bench.on("shown", () => showNotes(notes));
  bench.on("point", (found) => (found ? showFacts(point, found) : empty()));
  let isOld = false; // tables that nobody sees are made when they are looked at
  const tables = () => {
    isOld = panel.hidden;
    if (isOld || !bench.figures) return;
    showWorst(worst, bench.figures);
    showFeatures(features, bench.figures);
  };
  bench.on("figures", tables);
  bench.on("chosen", () => { if (isOld) tables(); });
  empty();
}

function showFacts(section, p) {
  const facts = [
    ["Feature", p.feature], ["Place", p.at_mm.map((x) => fixed(x)).join(", ") + " mm"],
    ["Made by", p.line > 0 ? `line ${p.line}, tool ${p.tool}, at ${clock(p.time_s)}` : "no move"],
    ["Feed, speed", `${Math.round(p.feed_mm_per_min)} mm/min, ${Math.round(p.spindle_rpm)} 1/min`],
    ["Axes", p.nose_mm.map((x, k) => "XYZ"[k] + fixed(x)).join(" ")],
    ["Models", Object.entries(p.predicted_um).map(([name, um]) => `${MODEL_WORDS[name]} ${signed(um)}`).join(" · ") + " µm"],
  ];
  if (p.residual_um !== undefined) facts.push(["Measured − predicted", `${signed(p.residual_um)} µm (u = ${fixed(p.u_um, 1)})`]);
  redraw(section, [
    el("h3", {}, `Point ${p.id} `, el("b", { class: "big" }, signed(p.predicted_um.abbe), " ", el("small", {}, "µm predicted"))),
    el("dl", { class: "facts" }, facts.map(([word, value]) => el("div", {}, el("dt", {}, word), el("dd", {}, value)))),
    shareBars(p.shares)]);
}

// One bar a source: to the right where it leaves material, to the left where it takes it.
function shareBars(shares) {
  const largest = Math.max(1e-9, ...shares.map((s) => Math.abs(s.um)));
  const shown = shares.filter((s) => Math.abs(s.um) >= 0.005).slice(0, MOST_SHARES), rest = shares.filter((s) => !shown.includes(s));
  const rows = shown.map((s) => {
    const bar = el("i", { class: s.um < 0 ? "gone" : "left" });
    bar.style.width = (50 * Math.abs(s.um)) / largest + "%";
    bar.style[s.um < 0 ? "right" : "left"] = "50%";
    return el("tr", {}, el("th", { scope: "row" }, s.source, " ", el("small", {}, componentWords(s.source))), el("td", { class: "bar" }, el("span", {}, bar)), el("td", { class: "value" }, signed(s.um)));
  });
  const sum = rest.reduce((total, s) => total + s.um, 0);
  if (rest.length) rows.push(el("tr", { class: "soft" }, el("th", { scope: "row" }, `${rest.length} smaller`), el("td"), el("td", { class: "value" }, signed(sum))));
  return el("table", { class: "shares" }, el("caption", {}, "Share of every error, µm: blue takes material, orange leaves it"), el("tbody", {}, rows));
}

function showWorst(section, figures) {
  if (bench.look.quantity === "uncertainty" || !figures.worst.length) return redraw(section, []);
  const rows = figures.worst.map((place, i) => {
    const button = el("button", { class: "rank", type: "button", title: "Turn the part to it" }, String(i + 1));
    button.onclick = () => faceWorst(place);
    return el("tr", {}, el("td", {}, button), el("td", {}, place.feature), el("td", {}, place.line > 0 ? "line " + place.line : ""), el("td", { class: "value" }, signed(place.um)));
  });
  redraw(section, [el("h3", {}, "Worst places"), el("table", { class: "rows" }, el("tbody", {}, rows))]);
}

function showFeatures(section, figures) {
  const number = isSigned() ? signed : fixed;
  const rows = figures.features.filter((f) => f.count).sort((a, b) => b.rms_um - a.rms_um).map((f) =>
    el("tr", {}, el("th", { scope: "row" }, f.name || "–"), el("td", { class: "value" }, fixed(f.rms_um)), el("td", { class: "value" }, number(f.low_um)), el("td", { class: "value" }, number(f.high_um))));
  if (!rows.length) return redraw(section, []);
  const head = el("tr", {}, ["Feature", "RMS", "from", "to, µm"].map((word) => el("th", { scope: "col" }, word)));
  redraw(section, [el("h3", {}, "Features"), el("table", { class: "rows" }, el("thead", {}, head), el("tbody", {}, rows))]);
}

function showNotes(section) {
  const { about } = bench, machined = bench.state.shown?.machined;
  if (!about) return;
  const facts = [
    ["Machine", about.machine], ["Chain", about.chain], ["Program", `${about.program}, ${about.moves} moves, ${clock(about.duration_s)}`],
    ["Effects", about.effects.join(", ") || "none beside the error tables"],
  ];
  redraw(section, [el("h3", {}, "The job"), machined ? el("p", { class: "lead" }, "It is machined: ",
    el("a", { href: showAddress(machined.page), target: "_blank", rel: "noopener" }, "its report")) : null,
    el("dl", { class: "facts" }, facts.map(([word, value]) => el("div", {}, el("dt", {}, word), el("dd", {}, value)))),
    ...about.notes.map((note) => el("p", { class: "remark" }, micro(note)))]);
}
