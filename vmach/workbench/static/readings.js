// Further readings: a file is dropped, its instrument named, and a new job of the chain has them.

import { attempt, bench, notice, once } from "./bench.js";
import { get, post, send } from "./api.js";
import { el, oneNumber, threeNumbers } from "./dom.js";

const state = { forms: null, file: null, section: null, isOpen: false, wanted: null };

// `wanted` says in words what to measure, the instrument first: its form is open at once.
export function readingsForm(wanted = null) {
  if (!state.section) state.section = makeForm();
  if (wanted !== state.wanted) {
    state.wanted = wanted;
    state.section.open ||= Boolean(wanted);
    state.section.choose();
  }
  return state.section;
}

// What a verdict asked for had opened it: another job's does not.
bench.on("part", () => Object.assign(state, { section: null, file: null, isOpen: state.isOpen && !state.wanted, wanted: null }));

function makeForm() {
  const fields = el("div", { class: "choices" }), kind = el("select", { "aria-label": "Instrument" });
  const told = el("p", { class: "soft" }), take = el("button", { type: "button", class: "primary", disabled: true }, "Add these readings");
  const choose = el("input", { type: "file", accept: ".csv,.txt", class: "hidden-file" });
  const word = el("span", {}, "Drop a file of readings here, or choose one");
  const drop = el("label", { class: "drop" }, word, choose);
  const show = () => {
    const form = state.forms?.find((one) => one.kind === kind.value);
    if (!form) return;
    const replaced = form.kind === "part" ? bench.about?.measured_file : null;
    told.textContent = (form.columns.length ? `Columns: ${form.columns.join(", ")}. ` : "")
      + (replaced ? `They take the place of ${replaced} in the new job; this job keeps it.` : "");
    fields.replaceChildren(...form.fields.map(fieldOf));
  };
  const upload = attempt(async (file) => {
    if (!file) return;
    const taken = await send(file);
    state.file = taken.file;
    word.textContent = `${taken.file} (${taken.bytes} bytes) is in the folder`;
    take.disabled = false;
  });
  choose.onchange = () => upload(choose.files[0]);
  drop.ondragover = (event) => event.preventDefault();
  drop.ondrop = (event) => { event.preventDefault(); upload(event.dataTransfer.files[0]); };
  kind.onchange = show;
  take.onclick = once(async () => {
    const settings = { kind: kind.value };
    for (const input of fields.querySelectorAll("[name]")) if (input.value.trim() !== "") settings[input.name] = READ[input.dataset.is](input.value, wordsFor(input.name));
    const { made, is_opened } = await post("/api/readings", { file: state.file, settings });
    if (!is_opened) notice(`${made} has the readings; another job was opened meanwhile.`, "news stay");
  });
  const made = el("details", { class: "readings", open: state.isOpen }, el("summary", {}, "Further readings"),
    drop, el("label", { class: "choice" }, el("span", {}, "Instrument"), kind), fields, told, take);
  made.isKept = true; // what was chosen in it stays
  made.ontoggle = attempt(async () => {
    state.isOpen = made.open;
    if (!made.open || kind.options.length) return;
    state.forms ??= (await get("/api/instruments")).forms;
    kind.append(...state.forms.map((form) => el("option", { value: form.kind }, form.title)));
    made.choose();
  });
  made.choose = () => {
    const fitting = state.forms?.find((form) => state.wanted?.toLowerCase().startsWith(form.kind));
    if (fitting && kind.options.length) kind.value = fitting.kind;
    show();
  };
  return made;
}

const READ = { choice: (text) => text, number: oneNumber, three: threeNumbers };
const wordsFor = (name) => (name === "u_um" ? "standard uncertainty, µm" : name.replace(/_mm$/, ", mm").replace(/_um$/, ", µm").replaceAll("_", " "));

function fieldOf(field) {
  const words = wordsFor(field.name);
  const input = field.is === "choice"
    ? el("select", { name: field.name }, field.choices.map((one) => el("option", { value: one, selected: one === field.value }, one)))
    : el("input", { name: field.name, class: "name", value: field.value ?? "", placeholder: field.is === "three" ? "X, Y, Z" : "", required: field.is_required });
  input.dataset.is = field.is;
  return el("label", { class: "choice" }, el("span", {}, words + (field.is_required ? "" : " (optional)")), input);
}
