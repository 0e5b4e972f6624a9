"use strict";

// Views of the part that turn together, one for each state of the model.
(() => {
  const byId = (id) => document.getElementById(id);
  const page = JSON.parse(byId("page-data").textContent);
  const canvases = [...document.querySelectorAll("canvas[data-variant]")];
  let scenes = [], picked = null;

  const both = Object.fromEntries(["orbit", "pan", "zoomAt", "home"].map(
    (name) => [name, (...values) => scenes.forEach((scene) => scene[name](...values))]));

  const signed = (um) => (um < 0 ? "−" : "+") + Math.abs(um).toFixed(2);

  function placeMarks(scene, canvas) {
    const marks = canvas.parentElement.querySelector(".marks");
    canvas.parentElement.querySelector(".triad").innerHTML = triad(scene);
    marks.replaceChildren();
    if (picked === null) return;
    const [x, y] = scene.toScreen([0, 1, 2].map((k) => scene.model.points[3 * picked + k]));
    const mark = document.createElement("div");
    mark.className = "mark dot";
    mark.style.transform = `translate(${x}px, ${y}px)`;
    marks.append(mark);
  }

  function pickAt(scene, x, y) {
    const hit = scene.pick(x, y), { model } = scene;
    picked = hit ? model.nearestPoint(hit.place, hit.normal) : null;
    if (picked === -1) picked = null;
    scenes.forEach((one) => one.redraw());
    if (picked === null) return;
    const c = model.columns, line = c.point_line[picked];
    const found = canvases.map(({ dataset }) => `${signed(model.deviation("point:" + dataset.variant, picked))} µm ${dataset.words}`);
    const place = [0, 1, 2].map((k) => model.points[3 * picked + k].toFixed(2).replace("-", "−")).join(", ");
    byId("picked").textContent = `Point ${model.ids[picked]} · ${model.features[c.point_feature[picked]]} at ${place} mm: `
      + `${found.join(", ")} · tool ${c.point_tool[picked]}, line ${line}: ${model.nc[line] ?? ""}`;
  }

  async function start() {
    try {
      const model = new Model(await readPayload(byId("payload").textContent));
      byId("stage").hidden = false;
      scenes = canvases.map((canvas) => {
        const scene = new Scene(canvas, model, page.colour_stops, page.unknown_colour);
        scene.onDraw = () => placeMarks(scene, canvas);
        scene.setLook({ range: page.range_um });
        scene.show(canvas.dataset.variant);
        listenToGestures(canvas, both, (x, y) => pickAt(scene, x, y));
        return scene;
      });
      byId("still").hidden = true;
      for (const button of document.querySelectorAll("[data-view]"))
        button.addEventListener("click", () => both.home(...VIEWS[button.dataset.view]));
    } catch (error) {
      byId("stage").hidden = true;
      byId("picked").textContent = `The turnable map is not available in this browser: ${error.message}.`;
    }
  }
  start();
})();
