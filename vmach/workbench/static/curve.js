// How the error fell, model by model: on what was fitted, and on what was held out.

import { attempt, bench, isAtWork, once } from "./bench.js";
import { get, post } from "./api.js";
import { el, fixed, shortNames, svg } from "./dom.js";
import { startRun } from "./runs.js";

const APART = 16; // px between the values of two marks of one model
const LETTERS = 48; // that fit below the axis side by side
const WIDTH = 380, HEIGHT = 190, LEFT = 40, RIGHT = 16, TOP = 14, BOTTOM = 26;

export function historyCurve() {
  const { chain } = bench.state;
  if (!chain || chain.length < 2) return null;
  const found = Object.fromEntries((bench.state.shown.history?.steps ?? []).map((step) => [step.job, step]));
  const steps = chain.map((step, i) => ({
    ...step,
    fitted: step.after_um ?? chain[i + 1]?.before_um ?? found[step.job]?.rms_um,
    heldOut: found[step.job]?.held_out_um,
    otherPart: found[step.job]?.check_rms_um,
  }));
  const isKnown = steps.some((step) => [step.fitted, step.heldOut, step.otherPart].some((v) => typeof v === "number"));
  return el("section", { class: "history" }, el("h3", {}, isKnown ? "How the error fell" : "Jobs of this chain"), isKnown ? plot(steps) : evaluate(), otherPart(), buttons(steps));
}

// Readings that were added say nothing of the error yet.
function evaluate() {
  if (!bench.about?.is_measured) return null;
  const button = el("button", { type: "button", disabled: isAtWork("history") }, "Evaluate the models");
  button.onclick = () => startRun("/api/history");
  return el("div", { class: "row" }, button, el("span", { class: "soft" }, "shows how the error fell"));
}

// Another measured part of the same machine: nothing is fitted to it, so its error falls only by what is true.
const offered = { jobs: [], revision: null };
function otherPart() {
  if (!bench.about?.is_measured) return null;
  askForJobs();
  const now = bench.state.shown.history?.other_part ?? null, open = `${bench.state.folder}/${bench.state.job}`;
  const ofChain = new Set(bench.state.chain.map((step) => `${bench.state.folder}/${step.job}`));
  const jobs = [...new Set([...(now ? [now] : []), ...offered.jobs])].filter((job) => job !== open && !ofChain.has(job)), names = shortNames(jobs);
  if (!jobs.length) return null;
  const select = el("select", { "aria-label": "Another part", disabled: isAtWork("history") }, el("option", { value: "", selected: !now }, "none"),
    jobs.map((job) => el("option", { value: job, selected: job === now }, names.get(job))));
  select.onchange = ({ target }) => startRun("/api/history", { other_part: target.value || null });
  return el("label", { class: "choice" }, el("span", {}, "Check on another measured part of this machine"), select);
}

const askForJobs = attempt(async () => {
  const { revision } = bench.state;
  if (offered.revision === revision) return;
  offered.revision = revision;
  offered.jobs = (await get("/api/start")).jobs;
  bench.tell("shown");
});

const key = (kind, words) => el("span", { class: "keyed" }, el("span", { class: "key " + kind }), words, " ");
const cut = (text, most) => (text.length > most ? text.slice(0, most - 1) + "…" : text);

function plot(steps) {
  const values = steps.flatMap((step) => [step.fitted, step.heldOut, step.otherPart]).filter((v) => v !== undefined && v !== null);
  const most = 1.1 * Math.max(0.1, ...values), decade = 10 ** Math.floor(Math.log10(most / 2));
  const step = [1, 2, 5, 10].map((n) => n * decade).find((one) => most / one <= 5), end = step * Math.ceil(most / step);
  const x = (i) => LEFT + ((WIDTH - LEFT - RIGHT) * (i + 0.5)) / steps.length;
  const y = (v) => HEIGHT - BOTTOM - ((HEIGHT - TOP - BOTTOM) * v) / end;
  const made = svg("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, class: "curve", role: "img", "aria-label": "RMS of measured minus predicted, model by model" });
  for (let v = 0; v <= end + step / 2; v += step) {
    made.append(svg("line", { class: "grid", x1: LEFT, x2: WIDTH - RIGHT, y1: y(v), y2: y(v) }),
      Object.assign(svg("text", { class: "tick", x: LEFT - 6, y: y(v) + 4, "text-anchor": "end" }), { textContent: fixed(v, Math.max(0, -Math.floor(Math.log10(step)))) }));
  }
  for (const [kind, key, word] of [["other", "otherPart", "other part"], ["held", "heldOut", "held out"], ["fitted", "fitted", "fitted"]]) {
    const known = steps.map((step, i) => [i, step[key], step]).filter(([, v]) => v !== undefined && v !== null);
    if (!known.length) continue;
    made.append(svg("polyline", { class: "line " + kind, points: known.map(([i, v]) => `${x(i)},${y(v)}`).join(" ") }));
    for (const [i, v, step] of known) {
      const mark = kind === "other"
        ? svg("path", { class: "mark-other", d: `M${x(i)},${y(v) - 11}l11,11l-11,11l-11,-11z` })
        : kind === "fitted"
        ? svg("circle", { class: "mark-" + kind, cx: x(i), cy: y(v), r: step.is_open ? 6 : 4 })
        : svg("rect", { class: "mark-" + kind, x: x(i) - 8, y: y(v) - 8, width: 16, height: 16 });
      mark.append(Object.assign(svg("title"), { textContent: `${word}: ${fixed(v)} µm` }));
      made.append(mark);
      if (kind === "other") { // beside the others, which are above and below
        made.append(Object.assign(svg("text", { class: "value other", x: x(i) + 14, y: y(v) + 4 }), { textContent: fixed(v) }));
        continue;
      }
      const other = kind === "held" ? step.fitted : step.heldOut;
      const above = kind === "held" || (other !== undefined && v > other);
      const isSame = kind === "fitted" && other !== undefined && other !== null && fixed(v) === fixed(other);
      if (isSame) continue; // one number says both
      made.append(Object.assign(svg("text", { class: "value", x: x(i), y: y(v) + (above ? -13 : APART + 2), "text-anchor": "middle" }), { textContent: fixed(v) }));
    }
  }
  steps.forEach((step, i) => made.append(Object.assign(
    svg("text", { class: "tick" + (step.is_open ? " open" : ""), x: x(i), y: HEIGHT - 7, "text-anchor": "middle" }),
    { textContent: i === 0 ? "as given" : cut("+ " + step.added.join(", "), Math.floor(LETTERS / steps.length)) })));
  return el("figure", {}, made, el("figcaption", {},
    key("fitted", "fitted readings, RMS in µm"),
    steps.some((step) => typeof step.heldOut === "number") ? key("held", "features left out of the fit") : null,
    steps.some((step) => typeof step.otherPart === "number") ? key("other", "the other part") : null));
}

function buttons(steps) {
  return el("ol", { class: "steps" }, steps.map((step) => {
    const button = el("button", { type: "button", disabled: step.is_open, title: step.job }, step.is_open ? "open" : step.is_later ? "Forward to it" : "Back to it");
    button.onclick = once(() => post("/api/open", { job: step.job }));
    return el("li", { class: step.is_later ? "later" : step.is_open ? "open" : "" },
      el("span", {}, el("b", {}, step.added.length ? "+ " + step.added.join(", ") : "as given"), " ", el("code", {}, step.job)), button);
  }));
}
