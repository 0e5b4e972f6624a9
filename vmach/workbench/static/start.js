// The start page: samples, jobs of before, jobs of this folder.

import { attempt, bench, notice, once, settle } from "./bench.js";
import { get, post } from "./api.js";
import { byId, el, shortNames } from "./dom.js";
import { newJobForm } from "./new_job.js";

// Work in another folder ends with it: the server asks first.
async function openJob(job, ends_work = false) {
  try {
    await post("/api/open", { job, ends_work });
    settle("end of work");
    hideStart(); // also where that job was open before
  } catch (error) {
    if (error.status !== 409) throw error;
    const button = el("button", { type: "button" }, "End it and open the job");
    button.onclick = once(() => openJob(job, true));
    notice([error.message, ". ", button], "news ask", "end of work");
  }
}

export const showStart = attempt(async () => {
  const found = await get("/api/start");
  byId("start").hidden = false;
  byId("bench").hidden = true;
  document.title = "vmach";
  const list = (title, rows, empty) => el("section", {}, el("h2", {}, title), rows.length ? el("ul", { class: "jobs" }, rows) : el("p", { class: "soft" }, empty));
  const row = (job, word, about) => {
    const button = el("button", { type: "button" }, el("b", {}, word), el("span", { class: "soft" }, about));
    button.onclick = once(() => openJob(job));
    return el("li", {}, button);
  };
  const recent = shortNames(found.recent), here = shortNames(found.jobs);
  const back = el("button", { type: "button", hidden: !bench.state.job }, "Back to the open job");
  back.onclick = () => { byId("start").hidden = true; byId("bench").hidden = false; };
  byId("start").replaceChildren(
    el("h1", {}, "What will the machine make of the part?"),
    el("p", { class: "lead" }, "Open a job: its part is predicted, compared with what was measured, and what the model lacks is named."), back,
    el("div", { class: "columns" },
      list("Samples", found.samples.map((one) => row(one.job, one.name, one.about)), "The samples come with the sources of vmach."),
      list("Opened before", found.recent.map((job) => row(job, recent.get(job), job)), "Nothing yet."),
      list("In this folder", found.jobs.map((job) => row(job, here.get(job), job)), `No job file in ${found.folder}.`)),
    newJobForm(found));
});

export function hideStart() {
  byId("start").hidden = true;
  byId("bench").hidden = false;
}
