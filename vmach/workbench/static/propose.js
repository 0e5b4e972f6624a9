// A law of one's own, where the catalogue ends: forms that are proposed, and an editor with the checker's words.

import { attempt, bench, isAtWork, once, settle } from "./bench.js";
import { get, post, put } from "./api.js";
import { el, fixed, micro, redraw, short, uncertain } from "./dom.js";
import { runBox, startRun } from "./runs.js";

const SKELETON = `"""What the effect is, in one sentence."""

from vmach.effects import Effect, along, linear


class OwnEffect(Effect):
    """What it is and why."""

    name = "own_effect"
    title = "a few words"
    parameters = (linear("amount_um", "what one unit of it is", usual=5.0),)
    targets = ("X", "Y", "Z")
    usual_size = "1 to 10 um"
    confirm = "how to see that it is there"
    cure = "what to do about it"
    source = "where the law comes from"

    def displacement(self, path, target, amount_um):
        # path.nose_mm (P, 3) mm, path.time_s, path.velocity_mm_per_s ...; result (P, 3) mm
        return along(target, 1e-3 * amount_um * path.nose_mm[:, 0] / 500.0)
`;
const DRAFT = "vmach-own-law"; // what was written and not saved, kept over a reload
const state = { file: "own_effect.py", isNew: true, editor: null };

export function proposePanel(panel) {
  const forms = el("section"), editing = editorSection(), says = el("section"), known = el("section");
  panel.append(forms, editing, says, known);
  const draw = () => {
    redraw(forms, proposals());
    redraw(says, said());
    redraw(known, looseEffects());
    if (!lastCheck()) settle("run check"); // what it said is of a text that is not there any more
  };
  for (const kind of ["part", "run", "shown", "state"]) bench.on(kind, draw);
  bench.on("run", attempt(async (run) => {
    if (run.kind === "propose" && run.state === "done" && run.result.file !== state.file) await load(run.result.file);
  }));
  bench.on("effect-text", attempt(async (file) => { if (file === state.file) await load(file); }));
  bench.on("part", attempt(async () => {
    const own = bench.state.own_effects?.[0];
    if (own && state.isNew) await load(own);
  }));
}

function proposals() {
  const found = bench.state.shown?.diagnosis?.proposals ?? [];
  const head = el("h3", {}, "Forms for what no effect explains");
  if (!found.length) return [head, el("p", { class: "soft" }, "A diagnosis whose verdict leaves something unexplained proposes forms here. You can also write a law of your own below.")];
  return [head, ...found.map((p, i) => {
    const name = el("input", { value: `proposed_${i + 1}`, "aria-label": "Name of the effect", class: "name", "data-free": "" });
    const write = el("button", { type: "button", class: "primary", disabled: isAtWork("propose") }, "Write it as an effect");
    write.onclick = ({ currentTarget }) => startRun("/api/propose", { name: currentTarget.closest("article").querySelector("input").value.trim(), number: i + 1 });
    return el("article", { class: "card" }, el("h4", {}, el("code", {}, p.formula)),
      el("p", {}, ...amount(p), `would leave ${fixed(p.remains_um)} µm`),
      heldOut(p.held_out_um), el("p", { class: "soft" }, "To refute it: ", micro(p.refuted_by)),
      el("div", { class: "row" }, name, write));
  }), runBox("propose")];
}

// several amounts have no size in common but what they do; those beyond two u are said
function amount(p) {
  const clear = (p.each ?? []).filter((one) => Math.abs(one.amount_um) > 2 * one.u_um);
  const every = p.amounts > 1 ? clear : [p];
  const each = every.flatMap((one) => [el("b", {}, short(one.amount_um)), ` µm (u = ${uncertain(one.u_um)})${one.of ? ` ${one.of}` : ""}, `]);
  return p.size_um === undefined ? each : [...each, `${fixed(p.size_um)} µm RMS of the readings, `];
}

function heldOut({ without, with: with_it }) {
  const row = (word, value, kind) => {
    const bar = el("i", { class: kind });
    bar.style.width = (100 * value) / Math.max(without, with_it, 1e-9) + "%";
    return el("tr", {}, el("th", { scope: "row" }, word), el("td", { class: "bar" }, bar), el("td", { class: "value" }, fixed(value), " µm"));
  };
  return el("table", { class: "bars" }, el("caption", {}, "Features that were not fitted"), el("tbody", {}, row("without", without, "before"), row("with it", with_it, "after")));
}

function editorSection() {
  const draft = readDraft();
  if (draft) Object.assign(state, { file: draft.file, isNew: false });
  const name = el("input", { value: state.file, class: "name", "aria-label": "File of the effect" });
  const area = el("textarea", { class: "editor", spellcheck: false, value: draft?.text ?? SKELETON, "aria-label": "Python of the effect" });
  const numbers = el("pre", { class: "numbers", "aria-hidden": "true" });
  const renumber = () => { numbers.textContent = area.value.split("\n").map((_, i) => i + 1).join("\n"); };
  const keepDraft = () => sessionStorage.setItem(DRAFT, JSON.stringify({ file: name.value, text: area.value }));
  area.oninput = () => { renumber(); keepDraft(); };
  name.oninput = keepDraft;
  area.onscroll = () => { numbers.scrollTop = area.scrollTop; };
  area.onkeydown = (event) => {
    if (event.key === "Tab" && !event.shiftKey && !event.ctrlKey && document.activeElement === area && area.dataset.free !== "1") {
      event.preventDefault();
      area.setRangeText("    ", area.selectionStart, area.selectionEnd, "end");
    }
    area.dataset.free = event.key === "Escape" ? "1" : ""; // Escape, then Tab leaves the editor
  };
  const check = el("button", { type: "button", class: "primary" }, "Save and check");
  check.onclick = once(async () => {
    state.file = name.value.trim();
    await put("/api/effect-file", { file: state.file, text: area.value });
    state.isNew = false;
    sessionStorage.removeItem(DRAFT);
    await startRun("/api/check-effect", { file: state.file });
  });
  state.editor = { name, area, renumber };
  renumber();
  return el("section", {}, el("h3", {}, "A law of your own"), el("div", { class: "row" }, name, check),
    el("div", { class: "editing" }, numbers, area),
    el("p", { class: "soft" }, "It is Python and runs on this machine with your rights. Escape, then Tab leaves the editor."));
}

function readDraft() {
  try {
    return JSON.parse(sessionStorage.getItem(DRAFT));
  } catch {
    return null;
  }
}

const load = attempt(async (file) => {
  const found = await get("/api/text?file=" + encodeURIComponent(file));
  sessionStorage.removeItem(DRAFT);
  Object.assign(state, { file: found.file, isNew: false });
  state.editor.name.value = found.file;
  state.editor.area.value = found.text;
  state.editor.renumber();
});

// Own effects that every command knows and no job has yet.
function looseEffects() {
  const files = bench.state.loose_effects ?? [];
  if (!files.length) return [];
  return [el("h3", {}, "Known, and not added"), el("ul", { class: "loose" }, files.map((file) => {
    const drop = el("button", { type: "button", title: "No command knows it any more; the file stays" }, "Drop");
    drop.onclick = once(() => post("/api/drop-effect", { file }));
    return el("li", {}, el("code", {}, file), " ", drop);
  }))];
}

const lastCheck = () => [...(bench.state.runs ?? [])].reverse().find((one) => one.kind === "check");

function said() {
  const run = lastCheck();
  if (!run) return [];
  const line = run.state === "failed" ? Number((run.message.match(/\.py:(\d+)/) ?? [])[1]) : NaN;
  const jump = el("button", { type: "button" }, `Go to line ${line}`);
  jump.onclick = () => goTo(line);
  const name = (run.result?.said ?? "").split(":")[0];
  const add = el("button", { type: "button", class: "primary", disabled: ["add", "rounds"].some(isAtWork) }, `Add ${name}`);
  add.onclick = () => startRun("/api/add", { effects: [name] });
  return [runBox("check"), Number.isFinite(line) ? jump : null,
    run.state === "done" ? el("pre", { class: "said" }, micro(run.result.said ?? "")) : null,
    run.state === "done" && bench.about?.is_measured ? el("div", { class: "row" }, add, el("span", { class: "soft" }, "The next diagnosis weighs it with the others.")) : null];
}

function goTo(line) {
  const { area } = state.editor, lines = area.value.split("\n");
  const start = lines.slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
  area.focus();
  area.setSelectionRange(start, start + (lines[line - 1] ?? "").length);
  area.scrollTop = Math.max(0, 18 * (line - 6));
}
