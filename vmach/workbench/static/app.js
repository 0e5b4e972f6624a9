// The page comes alive: state, events, tabs.

import { attempt, bench, notice, once, settle } from "./bench.js";
import { get, post } from "./api.js";
import { byId, el } from "./dom.js";
import { comparePanel } from "./compare.js";
import { compensatePanel } from "./compensate.js";
import { diagnosePanel } from "./diagnose.js";
import { listenToServer } from "./events.js";
import { lookPanel } from "./look.js";
import { listenToPlayer } from "./player.js";
import { clearMark, listenToProgram, openProgram } from "./program.js";
import { proposePanel } from "./propose.js";
import { listenToReports } from "./report.js";
import { showRunInHeader, takeRun } from "./runs.js";
import { hideStart, showStart } from "./start.js";
import { listenToControls, loadPart, setTolerance, showChoices, showPoint, stage } from "./stage.js";
import { whatIfPanel } from "./what_if.js";

const PANELS = { look: ["Look", lookPanel], "what-if": ["What if", whatIfPanel], diagnose: ["Diagnose", diagnosePanel],
  propose: ["Own law", proposePanel], compensate: ["Compensate", compensatePanel], compare: ["Compare", comparePanel] };
let shownRevision = null, shownPlace = null;

function makeTabs() {
  for (const [name, [word, fill]] of Object.entries(PANELS)) {
    const tab = el("button", { type: "button", id: "tab-" + name, role: "tab", "aria-controls": "panel-" + name }, word);
    const panel = el("section", { id: "panel-" + name, class: "panel", role: "tabpanel", "aria-labelledby": "tab-" + name, hidden: true });
    tab.onclick = () => choose(name);
    byId("tabs").append(tab);
    byId("panels").append(panel);
    fill(panel);
  }
  byId("tabs").onkeydown = (event) => {
    const names = Object.keys(PANELS), step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const now = names.findIndex((name) => byId("tab-" + name).getAttribute("aria-selected") === "true");
    const name = names[(now + step + names.length) % names.length];
    choose(name);
    byId("tab-" + name).focus();
  };
  choose("look");
}

export function choose(name) {
  for (const one of Object.keys(PANELS)) {
    byId("tab-" + one).setAttribute("aria-selected", String(one === name));
    byId("tab-" + one).tabIndex = one === name ? 0 : -1;
    byId("panel-" + one).hidden = one !== name;
  }
  bench.tell("chosen", name);
}

// ---- the job that is open, the same in all tabs

async function showState(state) {
  Object.assign(bench.state, { shown: {}, runs: [], chain: [] }, state);
  showRunInHeader();
  for (const button of document.querySelectorAll(".needs-job")) button.hidden = !state.job;
  showUndo();
  if (!state.job) {
    document.body.dataset.ready = "start";
    return showStart();
  }
  const place = `${state.folder}/${state.job}`;
  if (place !== shownPlace) {
    settle(); // what was wrong was so of another job
    document.body.classList.add("other-job"); // until its figures are there
  }
  if (place !== shownPlace) hideStart(); // a job that is read anew closes no form that is being filled in
  shownPlace = place;
  byId("job-name").textContent = state.name;
  document.title = `${state.name} – vmach`;
  if (state.revision === shownRevision) return bench.tell("state");
  shownRevision = state.revision;
  byId("job-about").textContent = state.job;
  await showJob(state.revision);
}

async function showJob(revision) {
  document.body.dataset.ready = "";
  byId("veil").hidden = false;
  byId("veil").textContent = "Reading the job …";
  try {
    const about = await get("/api/about");
    if (revision !== shownRevision) return;
    const isOther = bench.about?.program !== about.program || bench.about?.lines !== about.lines;
    bench.about = about;
    byId("job-about").textContent = `${bench.state.job} · ${about.machine}`;
    if (isOther || !stage.ownTolerance) setTolerance(about.tolerance_um);
    showChoices();
    clearMark();
    openProgram();
    await loadPart();
    if (revision !== shownRevision) return;
    document.body.classList.remove("other-job");
    showPoint(null);
    byId("veil").hidden = !stage.noPicture;
    byId("veil").textContent = stage.noPicture ?? "";
    settle("job");
    bench.tell("part");
    document.body.dataset.ready = "part";
  } catch (error) {
    if (revision !== shownRevision) return;
    const again = el("button", { type: "button" }, "Read it again");
    again.onclick = once(() => post("/api/reload"));
    byId("veil").replaceChildren(el("span", {}, error.message), again);
    notice(error.message, "error", "job");
    document.body.dataset.ready = "trouble";
  }
}

// One step back: what was done here, or else to the job before in the chain.
function showUndo() {
  const { chain, steps, job } = bench.state, at = (chain ?? []).findIndex((step) => step.is_open), before = chain?.[at - 1];
  const word = steps?.undo ?? (before ? "+ " + chain[at].added.join(", ") : null);
  Object.assign(byId("undo"), { hidden: !job || !word, textContent: word ? `Undo: ${word}` : "Undo", title: `${word ?? ""} (Ctrl-Z; no file goes away)` });
  Object.assign(byId("redo"), { hidden: !job || !steps?.redo, textContent: "Redo", title: `Do again: ${steps?.redo ?? ""}` });
  byId("undo").onclick = once(() => (steps?.undo ? post("/api/undo") : post("/api/open", { job: before.job })));
  byId("redo").onclick = once(() => post("/api/redo"));
}

// Texts have an undo of their own.
function listenToKeys() {
  document.addEventListener("keydown", (event) => {
    const isText = event.target.matches?.("textarea, input:not([type=range], [type=checkbox], [type=radio])");
    if (!(event.ctrlKey || event.metaKey) || isText) return;
    const key = event.key.toLowerCase(), button = key === "y" || (key === "z" && event.shiftKey) ? byId("redo") : key === "z" ? byId("undo") : null;
    if (!button || button.hidden) return;
    event.preventDefault();
    button.click();
  });
}

// ---- what happens

const HAPPENS = {
  hello: async (state) => { // as it is now; what follows are changes of it
    settle("lost");
    await showState(state);
  },
  job: showState,
  run: takeRun,
  changes: (what) => { bench.state.changes = what.changes; bench.tell("changes", what); },
  shown: (what) => { Object.assign(bench.state.shown, what); bench.tell("shown"); },
  steps: (steps) => { bench.state.steps = steps; showUndo(); },
  "effect-text": ({ file }) => bench.tell("effect-text", file),
  other: ({ job }) => { bench.state.other = job; bench.tell("other", job); },
  files: ({ names }) => notice(`${names.join(", ")} changed on the disk and was read again`, "news"),
  lost: () => notice("The workbench does not answer; waiting for it.", "lost", "lost"),
  ended: () => goodbye("The workbench has ended", "Another one answers at this address. Open the address that its vmach open printed."),
  goodbye: () => goodbye("The workbench is closed", "Everything that was done is in the job's folder; vmach open starts it again."),
};

function listen() {
  listenToServer((kind, what) => attempt(HAPPENS[kind])(what));
}

// What a job was made into, where another one was opened meanwhile, or what was made before the work was stopped.
function offerJob({ kind, state, result }) {
  if (!["add", "keep", "rounds"].includes(kind) || !["done", "failed", "stopped"].includes(state)) return;
  if (result.is_opened) return kind === "keep" ? null : choose("diagnose");
  if (!result.job) return;
  const button = el("button", { type: "button" }, "Open it"), name = result.job.split("/").at(-1);
  button.onclick = once(async () => { await post("/api/open", { job: name }); settle("made " + name); });
  const why = state === "done" ? "another job was opened meanwhile" : "it holds what was added before";
  notice([`${name} is written; ${why}. `, button], "news stay", "made " + name);
}

// What still runs, as a map that is drawn anew, finds its elements.
function goodbye(title, text) {
  for (const one of document.body.children) one.hidden = true;
  document.body.append(el("main", { class: "start" }, el("h1", {}, title), el("p", { class: "lead" }, text)));
}

function start() {
  makeTabs();
  listenToControls();
  listenToProgram();
  listenToPlayer();
  listenToKeys();
  byId("home").onclick = showStart;
  listenToReports();
  byId("shut-down").onclick = once(() => post("/api/shut-down"));
  bench.on("run", offerJob);
  listen();
}

start();
