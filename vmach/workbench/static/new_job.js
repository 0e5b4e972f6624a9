// A job made of files: program, machine, CAD, measured points, tools, zero and blank.

import { attempt, once } from "./bench.js";
import { get, post, send } from "./api.js";
import { el, oneNumber, threeNumbers } from "./dom.js";

const FILES = { program: ["NC program", [".nc", ".ngc", ".tap", ".mpf", ".h", ".txt"], true], machine: ["Machine file", [".toml"], true],
  nominal: ["Nominal CAD (STEP, STL)", [".step", ".stp", ".stl"], false], measured: ["Measured points (CSV)", [".csv"], false] };
const THREE = { zero_mm: ["G54: machine coordinates of the workpiece zero, mm", true], min_mm: ["Blank, lowest corner, mm", false], max_mm: ["Blank, highest corner, mm", false] };

const SIZES = { number: "T", diameter_mm: "diameter, mm", length_mm: "nose to tip, mm", corner_radius_mm: "corner radius, mm" };
let kept = null;

// What was filled in stays until its job is written, also while another page is looked at.
export function newJobForm(found) {
  kept ??= makeForm(found);
  kept.offer(found.files);
  return kept.form;
}

function makeForm(found) {
  let files = found.files;
  const selects = {}, rows = el("tbody", {});
  const fill = () => {
    for (const [key, [, endings, isNeeded]] of Object.entries(FILES)) {
      const kept = selects[key].value, fitting = files.filter((name) => endings.some((ending) => name.toLowerCase().endsWith(ending)));
      selects[key].replaceChildren(el("option", { value: "" }, isNeeded ? "choose …" : "none"), ...fitting.map((name) => el("option", { value: name, selected: name === kept }, name)));
    }
  };
  for (const key of Object.keys(FILES)) selects[key] = el("select", { name: key });
  fill();
  const word = el("span", {}, "Drop the files here, or choose them; those of this folder are offered below"), choose = el("input", { type: "file", multiple: true, class: "hidden-file" });
  const drop = el("label", { class: "drop" }, word, choose);
  const take = attempt(async (given) => {
    for (const file of given) {
      word.textContent = `Taking ${file.name} …`;
      await send(file);
    }
    files = (await get("/api/start")).files;
    fill();
    word.textContent = `${given.length} ${given.length === 1 ? "file is" : "files are"} in the folder`;
  });
  choose.onchange = () => take([...choose.files]);
  drop.ondragover = (event) => event.preventDefault();
  drop.ondrop = (event) => { event.preventDefault(); take([...event.dataTransfer.files]); };

  const addTool = () => rows.append(toolRow(rows.children.length + 1, found.shapes));
  const more = el("button", { type: "button" }, "One more tool");
  more.onclick = addTool;
  addTool();
  const name = el("input", { class: "name", name: "name", value: "job", required: true });
  const three = Object.fromEntries(Object.keys(THREE).map((key) => [key, el("input", { class: "name", placeholder: "X, Y, Z" })]));
  const choice = (text, input) => el("label", { class: "choice" }, el("span", {}, text), input);
  const form = el("form", { class: "new-job" }, drop,
    el("div", { class: "choices" }, choice("Name of the job", name),
      Object.entries(FILES).map(([key, [text]]) => choice(text, selects[key])),
      Object.entries(THREE).map(([key, [text]]) => choice(text, three[key]))),
    el("table", { class: "rows tools" }, el("thead", {}, el("tr", {}, ["T", "Shape", "Diameter, mm", "Nose to tip, mm", "Corner radius, mm"].map((text) => el("th", { scope: "col" }, text)))), rows),
    el("div", { class: "row" }, more, el("button", { class: "primary" }, "Write the job and open it")));
  const write = once(async () => {
    const told = { name: name.value.trim(), tools: [...rows.children].map(toolOf).filter(Boolean) };
    for (const key of Object.keys(FILES)) told[key] = selects[key].value || null;
    for (const [key, [what]] of Object.entries(THREE)) told[key] = three[key].value.trim() ? threeNumbers(three[key].value, what) : null;
    await post("/api/new-job", told);
    kept = null;
  });
  form.onsubmit = (event) => {
    event.preventDefault();
    write({ currentTarget: form.querySelector(".primary") });
  };
  const offer = (names) => { files = names; fill(); };
  return { offer, form: el("details", { class: "new" }, el("summary", {}, el("h2", {}, "A new job")), form) };
}

function toolRow(number, shapes) {
  const cell = (input) => el("td", {}, input), box = (name, value = "") => el("input", { class: "name", name, value, inputMode: "decimal", "aria-label": name });
  return el("tr", {}, cell(box("number", number)), cell(el("select", { name: "shape", "aria-label": "shape" }, Object.keys(shapes).map((shape) => el("option", {}, shape)))),
    cell(box("diameter_mm")), cell(box("length_mm")), cell(box("corner_radius_mm")));
}

function toolOf(row) {
  const value = (name) => row.querySelector(`[name=${name}]`).value.trim();
  if (!value("diameter_mm") && !value("length_mm")) return null;
  const tool = { shape: value("shape") };
  for (const [name, what] of Object.entries(SIZES)) if (value(name)) tool[name] = oneNumber(value(name), `tool ${value("number")}, ${what}`);
  return tool;
}
