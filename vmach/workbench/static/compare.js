// Compare: another job beside the open one, turning with it; the difference where the parts are alike.

import { attempt, bench, notice, settle } from "./bench.js";
import { bytes, framed, get, post, query } from "./api.js";
import { byId, el, fixed, redraw, shortNames, signed } from "./dom.js";
import { applyValues, isSigned, loadValues, needPicture, pairsOf, stage } from "./stage.js";

const other = { scene: null, about: null, figures: null, mine: null, isAlike: false, isDifference: false, jobs: null };

export function comparePanel(panel) {
  const draw = () => redraw(panel, parts());
  bench.on("other", attempt(async (job) => { await load(job); draw(); }));
  bench.on("part", attempt(async () => {
    other.jobs = null;
    draw();
    if (bench.state.other) await load(bench.state.other);
    const found = await get("/api/start");
    other.jobs = [...new Set([...found.jobs, ...found.recent, ...found.samples.map((one) => one.job)])].filter((job) => job !== `${bench.state.folder}/${bench.state.job}`);
    draw();
  }));
  bench.on("figures", attempt(async (figures) => {
    if (figures === other.difference) return;
    other.mine = figures;
    if (other.about) { await loadOther(); draw(); }
  }));
}

function parts() {
  const jobs = [...new Set([...(other.jobs ?? []), ...(bench.state.other ? [bench.state.other] : [])])], names = shortNames(jobs);
  const select = el("select", { "aria-label": "Job to compare with" }, el("option", { value: "" }, "nothing"),
    jobs.map((job) => el("option", { value: job, selected: job === bench.state.other }, names.get(job))));
  select.onchange = attempt(({ target }) => {
    settle("compare");
    return post("/api/compare", { job: target.value || null });
  });
  const rows = [el("label", { class: "choice" }, el("span", {}, "Compare with"), select),
    el("p", { class: "soft" }, "Two machines, two programs or two days: both parts turn together, in the same colours.")];
  if (!other.about) return rows;
  rows.push(table());
  if (other.isAlike) {
    const box = el("input", { type: "checkbox", checked: other.isDifference });
    box.onchange = attempt(async ({ target }) => {
      other.isDifference = target.checked;
      showViews();
      if (other.isDifference) await showDifference();
      else await loadValues();
    });
    rows.push(el("label", { class: "check" }, box, " show the difference: this part minus the other"));
  } else {
    rows.push(el("p", { class: "soft" }, "The parts are not the same, so there is no difference to show."));
  }
  return rows;
}

function table() {
  const { mine, figures: its } = other, number = isSigned() ? signed : fixed;
  const rows = [["RMS", "rms_um"], ["Mean", "mean_um"], ["Highest", "high_um"], ["Lowest", "low_um"]].map(([word, key]) =>
    el("tr", {}, el("th", { scope: "row" }, word), ...[mine, its].map((f) => el("td", { class: "value" }, (key === "rms_um" ? fixed : number)(f[key]))),
      el("td", { class: "value" }, signed(mine[key] - its[key]))));
  const head = ["µm", "this", "the other", "difference"].map((word) => el("th", { scope: "col" }, word));
  return el("table", { class: "rows" }, el("thead", {}, el("tr", {}, head)), el("tbody", {}, rows));
}

async function load(job) {
  if (!job) return putAway();
  try {
    needPicture();
    await show(job);
  } catch (error) {
    if (job !== bench.state.other) return; // another choice since
    notice(error.message, "error", "compare"); // it stays while the choice goes back to nothing
    await putAway();
    await post("/api/compare", { job: null });
  }
}

function putAway() {
  stage.scenes = stage.scene ? [stage.scene] : [];
  const wasThere = other.about !== null;
  Object.assign(other, { about: null, figures: null, isDifference: false });
  showViews();
  return wasThere ? loadValues() : null;
}

async function show(job) {
  byId("other-view").hidden = false;
  byId("other-caption").textContent = "Machining the other part …";
  const [about, packed] = [await get("/api/other/about"), await bytes("/api/other/mesh")];
  if (job !== bench.state.other) return; // another choice since
  const model = new Model(await unpackPayload(packed)), mine = stage.scene.model;
  other.about = about;
  other.isAlike = model.vertices.length === mine.vertices.length && model.vertices.every((x, i) => Math.abs(x - mine.vertices[i]) < 1e-2);
  if (other.scene) other.scene.load(model);
  else {
    other.scene = new Scene(byId("other-canvas"), model, bench.state.colour_stops, bench.state.unknown_colour);
    listenToGestures(byId("other-canvas"), stage.together, () => {});
  }
  stage.scenes = [stage.scene, other.scene];
  for (const name of ["azimuth", "elevation", "zoom"]) other.scene[name] = stage.scene[name];
  byId("other-caption").textContent = about.name;
  const wasDifference = other.isDifference;
  other.isDifference &&= other.isAlike;
  showViews();
  if (wasDifference && !other.isDifference) return loadValues(); // the figures that come load the other's
  await loadOther();
}

// Both parts, or their difference alone: its colours are not theirs.
function showViews() {
  byId("other-view").hidden = !other.about || other.isDifference;
  byId("caption").hidden = !other.about;
  byId("caption").textContent = other.isDifference ? `${bench.about.name} − ${other.about.name}` : bench.about.name;
}

async function loadOther() {
  const job = bench.state.other, names = other.about.quantities.map((one) => one.name);
  const quantity = names.includes(bench.look.quantity) ? bench.look.quantity : "deviation";
  const found = await framed("/api/other/values?" + query({ ...bench.look, quantity }));
  if (job !== bench.state.other || !found[1].length) return; // it was put away meanwhile
  other.figures = found[0];
  other.scene.setValues(pairsOf(found[1]));
  other.scene.setLook({ range: stage.rangeUm });
  if (other.isDifference && other.isAlike) await showDifference();
}

// This part minus the other, at the points of both.
async function showDifference() {
  const job = bench.state.other;
  const [figures, values] = await framed("/api/other/difference?" + query({ ...bench.look, tolerance_um: stage.toleranceUm || null }));
  if (job !== bench.state.other || !other.isDifference) return; // it was put away meanwhile
  other.difference = { ...figures, isOfTwo: true };
  applyValues(other.difference, values);
}
