// The one-file report: of what is on the screen, or of the job with its virtual part.

import { bench, notice, once, settle } from "./bench.js";
import { downloadAddress, post, showAddress } from "./api.js";
import { byId, el } from "./dom.js";
import { startRun } from "./runs.js";
import { needPicture, stage } from "./stage.js";

const WIDEST = 1600, QUALITY = 0.85;

export function listenToReports() {
  byId("machine").onclick = () => startRun("/api/machine");
  byId("report").onclick = once(async () => {
    const scene = needPicture();
    const view = { azimuth_rad: scene.azimuth, elevation_rad: scene.elevation, zoom: scene.zoom, target_mm: [...scene.target],
      section: scene.look.section, range_um: stage.rangeUm };
    const { page } = await post("/api/report", { shown: bench.look, tolerance_um: stage.toleranceUm, view, picture: picture(scene), is_difference: Boolean(bench.figures?.isOfTwo) });
    offer("The report of what is on the screen is made.", page, "report");
  });
  bench.on("run", (run) => {
    if (run.kind === "machine" && run.state === "done") offer("The part is machined, and its report made.", run.result.page, "machined");
  });
}

// The canvas as it is drawn now, on white; a canvas forgets its picture when it has been shown.
function picture(scene) {
  const { canvas } = scene, share = Math.min(1, WIDEST / canvas.width), made = document.createElement("canvas"), pen = made.getContext("2d");
  Object.assign(made, { width: Math.round(share * canvas.width), height: Math.round(share * canvas.height) });
  pen.fillStyle = "#ffffff";
  pen.fillRect(0, 0, made.width, made.height);
  scene.draw();
  pen.drawImage(canvas, 0, 0, made.width, made.height);
  return made.toDataURL("image/jpeg", QUALITY);
}

function offer(word, page, about) {
  settle(about);
  notice([word, " ", el("a", { href: showAddress(page), target: "_blank", rel: "noopener" }, "Open it"), " · ",
    el("a", { href: downloadAddress(page), download: "" }, "download")], "news stay", about);
}
