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

const MOST_TROUBLES = 3, NEWS_MS = 4000;

// A message that stays until it is closed, or until what it is `about` has changed; plain news go by themselves.
export function notice(text, kind = "error", about = null) {
  const parts = [text].flat(), words = parts.map((part) => part.textContent ?? part).join("");
  const known = [...byId("notices").children].find((one) => one.dataset.text === words);
  if (known) return known;
  if (about) settle(about);
  const close = el("button", { class: "close", title: "Dismiss", type: "button" }, "×");
  const made = el("div", { class: "notice " + kind }, el("p", {}, parts), close);
  Object.assign(made.dataset, { text: words, about: about ?? "" });
  close.onclick = () => made.remove();
  byId("notices").append(made);
  if (kind === "news") setTimeout(() => made.remove(), NEWS_MS);
  for (const old of [...byId("notices").querySelectorAll(".error")].slice(0, -MOST_TROUBLES)) old.remove();
  return made;
}

// What was wrong is so no more; without `about`, all that was wrong.
export function settle(about = null) {
  for (const one of [...byId("notices").children])
    if (about ? one.dataset.about === about : one.classList.contains("error")) one.remove();
}

// Do something for a click; what is refused is said in the page, until it goes well.
export const attempt = (work) => {
  let said = null;
  return async (...values) => {
    try {
      const found = await work(...values);
      said?.remove();
      said = null;
      return found;
    } catch (error) {
      said?.remove();
      said = notice(error.message);
      if (!(error.name === "Error" || error.constructor.name === "Refused")) console.error(error);
    }
  };
};

// The same for a button that is disabled from the click to the answer: a second click does nothing.
export const once = (work) => {
  const tried = attempt(work);
  return async (event) => {
    const button = event.currentTarget;
    if (button.dataset.busy) return;
    Object.assign(button, { disabled: true });
    button.dataset.busy = "1";
    try {
      await tried(event);
    } finally {
      delete button.dataset.busy;
      button.disabled = false;
    }
  };
};

export function isAtWork(kind) {
  return (bench.state.runs ?? []).some((run) => run.kind === kind && ["waiting", "running"].includes(run.state));
}
