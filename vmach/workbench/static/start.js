// The start page: samples, jobs of before, jobs of this folder.

import { attempt, bench } from "./bench.js";
import { get, post } from "./api.js";
import { byId, el } from "./dom.js";
import { newJobForm } from "./new_job.js";

const openJob = attempt(async (job) => { await post("/api/open", { job }); });

export const showStart = attempt(async () => {
  const found = await get("/api/start");
  byId("start").hidden = false;
  byId("bench").hidden = true;
  document.title = "vmach";
  const list = (title, rows, empty) => el("section", {}, el("h2", {}, title), rows.length ? el("ul", { class: "jobs" }, rows) : el("p", { class: "soft" }, empty));
  const row = (job, word, about) => {
    const button = el("button", { type: "button" }, el("b", {}, word), el("span", { class: "soft" }, about));
    button.onclick = () => openJob(job);
    return el("li", {}, button);
  };
  const last = (path) => path.split("/").slice(-2).join("/");
  const back = el("button", { type: "button", hidden: !bench.state.job }, "Back to the open job");
  back.onclick = () => { byId("start").hidden = true; byId("bench").hidden = false; };
  byId("start").replaceChildren(
    el("h1", {}, "What will the machine make of the part?"),
    el("p", { class: "lead" }, "Open a job: its part is predicted, compared with what was measured, and what the model lacks is named."), back,
    el("div", { class: "columns" },
      list("Samples", found.samples.map((one) => row(one.job, one.name, one.about)), "The samples come with the sources of vmach."),
      list("Opened before", found.recent.map((job) => row(job, last(job), job)), "Nothing yet."),
      list("In this folder", found.jobs.map((job) => row(job, last(job), job)), `No job file in ${found.folder}.`)),
    newJobForm(found));
});

export function hideStart() {
  byId("start").hidden = true;
  byId("bench").hidden = false;
}
