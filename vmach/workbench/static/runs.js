// Work that takes a while: what it does, how far it is, a way to stop it, and why it failed.

import { attempt, bench, isAtWork, notice, settle } from "./bench.js";
import { post } from "./api.js";
import { byId, commandLine, el, redraw } from "./dom.js";

const WORDS = { diagnose: "Diagnosing", add: "Adding", rounds: "Adding in rounds", history: "Evaluating the models", propose: "Writing the proposal",
  check: "Checking the effect", keep: "Writing the job", compensate: "Compensating", machine: "Machining the part",
  collisions: "Looking for collisions" };

const stop = attempt((run) => post(`/api/runs/${run.number}/stop`));

function progressOf(run) {
  const bar = el("progress", run.share === null ? {} : { value: run.share, max: 1 });
  bar.setAttribute("aria-label", WORDS[run.kind] ?? run.kind);
  const button = el("button", { type: "button", class: "stop" }, "Stop");
  button.onclick = () => stop(run);
  return [el("span", {}, `${WORDS[run.kind] ?? run.kind}${run.stage ? ": " + run.stage : run.state === "waiting" ? ": waiting" : ""}`), bar, button];
}

export function showRunInHeader() {
  const run = (bench.state.runs ?? []).find((one) => ["running", "waiting"].includes(one.state));
  byId("run").hidden = !run;
  redraw(byId("run"), run ? progressOf(run) : []);
}

// A run's box in a panel: its command, how far it is, or what went wrong; of a run that went well
// only where it is wanted.
export function runBox(kind, isWanted = true) {
  const run = [...(bench.state.runs ?? [])].reverse().find((one) => one.kind === kind);
  if (!run || (!isWanted && run.state === "done")) return null;
  const parts = [];
  if (isAtWork(kind)) parts.push(el("div", { class: "progress" }, ...progressOf(run)));
  if (run.state === "failed") parts.push(el("p", { class: "trouble", role: "alert" }, run.message));
  if (run.state === "stopped") parts.push(el("p", { class: "soft" }, run.message));
  return el("div", { class: "run-box" }, ...parts, commandLine(run.command));
}

const asked = new Set();
const begin = attempt(async (address, what) => {
  const run = await post(address, what);
  if (!(bench.state.runs ?? []).some((one) => one.number === run.number)) takeRun(run);
});

// The server tells all tabs of the run, this one too. A second click before the answer does nothing.
export async function startRun(address, what = {}) {
  if (asked.has(address)) return;
  asked.add(address);
  try {
    await begin(address, what);
  } finally {
    asked.delete(address);
  }
}

export function takeRun(run) {
  const runs = bench.state.runs ?? (bench.state.runs = []);
  const at = runs.findIndex((one) => one.number === run.number), before = at < 0 ? null : runs[at];
  if (at < 0) runs.push(run);
  else runs[at] = run;
  if (run.state === "failed" && before?.state !== "failed") notice(run.message, "error", "run " + run.kind);
  else if (run.state !== before?.state) settle("run " + run.kind);
  if (run.state === "stopped" && before?.state !== "stopped") notice(`${WORDS[run.kind] ?? run.kind}: ${run.message}`, "news");
  showRunInHeader();
  bench.tell("run", run);
}
