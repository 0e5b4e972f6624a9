// What this tab knows, and who wants to be told when it changes.

import { byId, el } from "./dom.js";

export const bench = {
  state: { job: null, runs: [], chain: [] }, // as the server keeps it, the same in all tabs
  about: null, // of the open job
  look: { quantity: "deviation", model: "abbe" },
  figures: null, // of what is shown
  point: null, // that was clicked
  cards: [], // of all effects, with the meaning of their parameters
  listeners: new Map(),
  on(kind, listener) {
    if (!this.listeners.has(kind)) this.listeners.set(kind, []);
    this.listeners.get(kind).push(listener);
  },
  tell(kind, what) {
    for (const listener of this.listeners.get(kind) ?? []) listener(what);
  },
};

// A message that stays until it is closed; plain news go by themselves.
export function notice(text, kind = "error") {
  const known = [...byId("notices").children].find((one) => one.dataset.text === text);
  if (known) return;
  const close = el("button", { class: "close", title: "Dismiss", type: "button" }, "×");
  const made = el("div", { class: "notice " + kind }, el("p", {}, text), close);
  made.dataset.text = text;
  close.onclick = () => made.remove();
  byId("notices").append(made);
  if (kind === "news") setTimeout(() => made.remove(), 4000);
}

// Do something for a click; what is refused is said in the page.
export const attempt = (work) => async (...values) => {
  try {
    return await work(...values);
  } catch (error) {
    notice(error.message);
    if (!(error.name === "Error" || error.constructor.name === "Refused")) console.error(error);
  }
};

export function isAtWork(kind) {
  return (bench.state.runs ?? []).some((run) => run.kind === kind && ["waiting", "running"].includes(run.state));
}
