// Compensate: choices, progress, before and after, what changed in the text, and the program to take along.

import { attempt, bench, isAtWork, once } from "./bench.js";
import { downloadAddress, get, showAddress } from "./api.js";
import { el, fixed, micro, oneNumber, redraw } from "./dom.js";
import { runBox, startRun } from "./runs.js";

const DIALECTS = ["", "fanuc", "grbl", "haas", "heidenhain", "linuxcnc", "sinumerik"];
// name, what it is for people, its usual value; text and not a number's field, which would drop a decimal comma
const SIZES = [["resolution_mm", "Resolution of the control, mm", 0.001], ["tolerance_um", "Largest residual before rounding, µm", 0.1],
  ["residual_limit_um", "Largest residual as written, µm", 5], ["limit_um", "Largest correction accepted, µm", 500]];
const state = { difference: null, of: null };

export function compensatePanel(panel) {
  const form = choices(), result = el("section");
  panel.append(form, result);
  const draw = () => redraw(result, parts());
  for (const kind of ["part", "run", "shown"]) bench.on(kind, draw);
  bench.on("part", () => { Object.assign(state, { difference: null, of: null }); draw(); });
  state.draw = draw;
}

function choices() {
  const select = (name, options) => el("select", { name }, options.map(([value, word]) => el("option", { value }, word)));
  const size = ([name, word, value]) => row(word, el("input", { name, value, class: "name", inputMode: "decimal", title: `--${name.replaceAll("_", "-")} of the command` }));
  const row = (word, input) => el("label", { class: "choice" }, el("span", {}, word), input);
  const form = el("form", { class: "choices" },
    row("Keep in place", select("aim", [["tool", "the tool's tip"], ["part", "the surface"]])),
    row("Error model", select("model", [["abbe", "Abbe-consistent"], ["htm", "conventional HTM"]])),
    row("Written for", select("dialect", DIALECTS.map((d) => [d, d || "its own control"]))),
    SIZES.map(size),
    el("button", { class: "primary", id: "compensate" }, "Compensate"));
  const compensate = once(() => {
    const given = new FormData(form), what = { aim: given.get("aim"), model: given.get("model"), dialect: given.get("dialect") };
    for (const [name, word] of SIZES) what[name] = oneNumber(given.get(name), word);
    return startRun("/api/compensate", what);
  });
  form.onsubmit = (event) => {
    event.preventDefault();
    compensate({ currentTarget: form.querySelector("#compensate") });
  };
  return form;
}

function parts() {
  const found = bench.state.shown?.compensation, box = runBox("compensate", Boolean(found));
  if (isAtWork("compensate")) return [box];
  if (!found) return [box ?? el("p", { class: "soft" }, "Moves the program against the predicted error, reads it back and checks it.")];
  const { figures, program, page, run } = found;
  if (state.of !== run) loadDifference(run, program);
  return [figuresTable(figures), el("div", { class: "row" },
    el("a", { class: "button primary", href: downloadAddress(program), download: "" }, "Download the program"),
    el("a", { href: showAddress(page), target: "_blank", rel: "noopener" }, "its report")),
    ...figures.notes.map((note) => el("p", { class: "remark" }, micro(note))),
    figures.uncorrected.length ? el("p", { class: "remark" }, "Not corrected: " + figures.uncorrected.map(uncorrected).join("; ")) : null,
    differenceView(), box];
}

function figuresTable(f) {
  const rows = [["Tool off its path, largest", f.before_largest_um, f.after_largest_um], ["Tool off its path, mean", f.before_mean_um, f.after_mean_um]];
  if (f.surface) rows.push(["Part, largest", f.surface.before_largest_um, f.surface.after_largest_um], ["Part, mean", f.surface.before_mean_um, f.surface.after_mean_um]);
  const head = ["", "before", "after", ""].map((word) => el("th", { scope: "col" }, word));
  return el("section", {}, el("h3", {}, "Before and after"), el("table", { class: "rows" }, el("thead", {}, el("tr", {}, head)), el("tbody", {}, rows.map(([word, before, after]) => {
    const bar = el("i", { class: "after" });
    bar.style.width = Math.min(100, (100 * after) / Math.max(before, 1e-9)) + "%";
    return el("tr", {}, el("th", { scope: "row" }, word), el("td", { class: "value" }, fixed(before)), el("td", { class: "value" }, fixed(after), " µm"), el("td", { class: "bar narrow" }, bar));
  }))), el("p", { class: "soft" }, `${expected(f.surface)}largest correction ${fixed(f.largest_correction_um)} µm; ${fixed(f.growth)} times as many blocks; ${f.arcs_kept} of ${f.arcs} arcs stay arcs`));
}

// The model is not the machine: tables and effects have an uncertainty, which the part has too.
function expected(surface) {
  if (!surface) return "";
  return `to be expected on the machine: ${fixed(surface.expected_rms_um)} µm RMS, of it ${fixed(surface.after_rms_um)} in the model and ${fixed(surface.u_rms_um)} by the uncertainty of tables and effects; `;
}

const loadDifference = attempt(async (number, program) => {
  Object.assign(state, { of: number, difference: null });
  state.difference = await get("/api/difference?file=" + encodeURIComponent(program));
  state.draw();
});

// What a path cannot correct, with its size as the command tells it.
function uncorrected({ what, urad, surface_um }) {
  const sizes = [typeof urad === "number" ? `${fixed(urad, 1)} µrad` : null, typeof surface_um === "number" ? `${fixed(surface_um)} µm on the part` : null];
  const said = sizes.filter(Boolean).join(", ");
  return micro(what) + (said ? `, up to ${said}` : "");
}

const linesOf = (count) => `${count} ${count === 1 ? "line" : "lines"}`;

function differenceView() {
  const d = state.difference;
  if (!d) return el("p", { class: "soft" }, "Comparing the texts …");
  if (d.is_long) return el("p", { class: "soft" }, `${d.before} lines became ${d.after}: too many to be compared in the page.`);
  const marks = { " ": "same", "-": "old", "+": "new" };
  return el("details", { class: "difference", open: true, "data-free": "" }, el("summary", {}, `${linesOf(d.removed)} replaced by ${d.added}${d.is_cut ? ", the first of all" : ""}; ${d.before} → ${linesOf(d.after)}`),
    el("div", { class: "hunks" }, d.hunks.map((hunk) => el("div", { class: "hunk" }, el("p", { class: "soft" }, `from line ${hunk.line}`),
      hunk.rows.map(([mark, text]) => el("div", { class: marks[mark] }, el("span", {}, mark === "-" ? "−" : mark), text))))));
}
