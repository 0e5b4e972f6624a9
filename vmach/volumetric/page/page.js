"use strict";

// Cones that can be turned; the two points of the largest difference are numbered.
(() => {
  const byId = (id) => document.getElementById(id);
  const page = JSON.parse(byId("page-data").textContent);

  function placeMarks(scene) {
    byId("triad").innerHTML = triad(scene);
    byId("marks").replaceChildren(...page.marks.map((place, k) => {
      const [x, y] = scene.toScreen(place), mark = document.createElement("div");
      mark.className = "mark";
      mark.textContent = k + 1;
      mark.style.transform = `translate(${x}px, ${y}px)`;
      return mark;
    }));
  }

  function makeTicks() {
    for (let k = 0; k <= 4; k++) {
      const tick = document.createElement("li");
      tick.textContent = `${((page.largest_um * k) / 4).toPrecision(3)} µm`;
      tick.style.top = `${100 - 25 * k}%`;
      byId("ticks").append(tick);
    }
  }

  async function start() {
    try {
      const model = new Model(await readPayload(byId("payload").textContent));
      byId("stage").hidden = false;
      const scene = new Scene(byId("canvas"), model, page.colour_stops, page.colour_stops[0]);
      if (matchMedia("(prefers-color-scheme: dark)").matches)
        scene.gl.uniform3fv(scene.uniform("lineColour"), [0.5, 0.56, 0.62]);
      scene.onDraw = () => placeMarks(scene);
      scene.setLook({ range: page.largest_um / 2 || 1 });
      scene.show("error");
      listenToGestures(byId("canvas"), scene, () => {});
      makeTicks();
      byId("still").hidden = true;
      for (const button of document.querySelectorAll("[data-view]"))
        button.addEventListener("click", () => scene.home(...VIEWS[button.dataset.view]));
    } catch (error) {
      byId("stage").hidden = true;
      byId("still-note").textContent = `The turnable cones are not available in this browser: ${error.message}.`;
    }
  }
  start();
})();
