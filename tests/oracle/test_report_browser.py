"""A real browser opens the report, draws the map and shows the same figures."""

import html
import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from tests.report_case import block, points, run
from tests.small_job import write_job
from vmach.commands.accuracy import accuracy
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.diagnosis.results import write_diagnosis
from vmach.report import build_display_mesh, write_report_html
from vmach.report.page.kit import viewer_scripts

SAMPLES = Path(__file__).parents[2] / "samples"
BROWSER = shutil.which("chromium") or shutil.which("chromium-browser")
OPTIONS = (
    "--headless --no-sandbox --disable-quic --no-first-run --disable-background-networking "
    "--disable-component-update --disable-sync --use-gl=angle --use-angle=swiftshader "
    "--enable-unsafe-swiftshader --virtual-time-budget=5000 --dump-dom"
)


@pytest.mark.skipif(BROWSER is None, reason="chromium is not installed")
def test_the_page_starts_and_agrees_with_the_numbers(tmp_path):
    case = points()
    write_report_html(tmp_path / "r.html", build_display_mesh(*block(), case), case, run())
    page = subprocess.run(
        [BROWSER, *OPTIONS.split(), f"--user-data-dir={tmp_path / 'profile'}",
         (tmp_path / "r.html").as_uri()],
        capture_output=True, text=True, timeout=60, check=True,
    ).stdout  # fmt: skip
    assert re.search(r'<div class="stage" id="stage">', page)  # no longer hidden
    assert re.search(r'<figure id="still" hidden', page)
    assert len(re.findall(r'<div class="mark"', page)) == 10
    deviation = case["abbe"].deviation_mm[case["abbe"].is_cut]
    share = 100 * (np.abs(deviation) > 3e-3).mean()
    assert f'data-outside="abbe">{share:.2f} %' in page


@pytest.mark.skipif(BROWSER is None, reason="chromium is not installed")
def test_both_views_of_a_diagnosis_start(tmp_path):
    # the part was "measured" exactly nominal: the table stretches X by 100 ppm too much
    job = write_job(tmp_path, {"EXX": (lambda x: 0.1 * x, (0, 0, -100))})
    write_diagnosis(tmp_path / "out", diagnose(survey_job(job)), command="vmach diagnose")
    page = subprocess.run(
        [BROWSER, *OPTIONS.split(), f"--user-data-dir={tmp_path / 'profile'}",
         (tmp_path / "out" / "diagnosis.html").as_uri()],
        capture_output=True, text=True, timeout=60, check=True,
    ).stdout  # fmt: skip
    assert len(re.findall("<canvas data-variant", page)) == 2
    assert re.search(r'<div class="pair" id="stage">', page)  # no longer hidden
    assert re.search(r'<div class="pair" id="still" hidden', page)
    assert len(re.findall(r'class="triad"[^>]*><line', page)) == 2


@pytest.mark.skipif(BROWSER is None, reason="chromium is not installed")
def test_cones_of_the_accuracy_page_start(tmp_path):
    accuracy(SAMPLES / "mazak_ajv25/machine.toml", tool_length=200.0, grid="5", out=tmp_path / "o")
    page = subprocess.run(
        [BROWSER, *OPTIONS.split(), f"--user-data-dir={tmp_path / 'profile'}",
         (tmp_path / "o" / "accuracy.html").as_uri()],
        capture_output=True, text=True, timeout=60, check=True,
    ).stdout  # fmt: skip
    assert re.search(r'<div class="stage" id="stage">', page)  # no longer hidden
    assert re.search(r'<figure id="still" hidden', page)
    assert len(re.findall(r'<div class="mark"', page)) == 2
    assert len(re.findall(r"<li style=[^>]*>[\d.]+ µm</li>", page)) == 5


@pytest.mark.skipif(BROWSER is None, reason="chromium is not installed")
def test_rows_stay_low_on_a_narrow_screen(tmp_path):
    """Each word of a feature stood on a line of its own, while the table scrolled sideways."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="no Playwright")
    case = points(name="the face at the end of the long pocket")
    write_report_html(tmp_path / "r.html", build_display_mesh(*block(), case), case, run())
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=BROWSER, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 500, "height": 900})
        page.goto((tmp_path / "r.html").as_uri())
        heights = [row.bounding_box()["height"] for row in page.locator("tr[data-worst]").all()
                   if row.is_visible()]  # fmt: skip
        browser.close()
    assert len(heights) == 10
    assert max(heights) < 110


#: a flat square of 100 mm with a step, in 2 x 28,800 triangles; what is drawn is counted
SQUARE = """
window.requestAnimationFrame = (work) => setTimeout(work, 16); // no frame waits for the one before
const n = 120, vertices = [], normals = [], triangles = [];
for (const z of [0, 10]) for (let i = 0; i <= n; i++) for (let j = 0; j <= n; j++) {
  const k = vertices.length / 3;
  vertices.push((100 * i) / n, (100 * j) / n, z);
  normals.push(0, 0, 1);
  if (i < n && j < n) triangles.push(k, k + n + 1, k + 1, k + 1, k + n + 1, k + n + 2);
}
const model = Object.assign(Object.create(Model.prototype), { vertices: Float32Array.from(vertices),
  normals: Float32Array.from(normals), triangles: Uint32Array.from(triangles), low: [0, 0, 0],
  high: [100, 100, 10], centre: [50, 50, 5], radius: 71 });
model.outline = model.sharpEdges();
const fewer = fewerTriangles(model), drawn = [];
let area = 0, lowest = Infinity;
for (let i = 0; i < fewer.length; i += 3) {
  const place = (v) => [...model.vertices.subarray(3 * v, 3 * v + 3)];
  const [a, b, c] = [0, 1, 2].map((k) => place(fewer[i + k]));
  const up = cross(b.map((x, k) => x - a[k]), c.map((x, k) => x - a[k]))[2] / 2;
  area += up;
  lowest = Math.min(lowest, up);
}
const scene = new Scene(document.querySelector("canvas"), model, ["#0a2f6b", "#7a1a0c"], "#9aa0a6");
const draw = scene.gl.drawElements;
scene.gl.drawElements = (kind, count, ...more) => {
  if (kind === scene.gl.TRIANGLES) drawn.push(count / 3);
  draw.call(scene.gl, kind, count, ...more);
};
const after = (ms) => new Promise((done) => setTimeout(done, ms));
(async () => {
  await after(300);
  for (const ms of [1, 1000]) { // a whole picture is quick, or slow
    scene.smooth.took_ms = ms;
    scene.orbit(10, 0);
    await after(700);
    drawn.push("rest");
  }
  document.body.dataset.told = JSON.stringify({ fewer: fewer.length / 3, area, lowest, drawn });
})();
"""


@pytest.mark.skipif(BROWSER is None, reason="chromium is not installed")
def test_a_slow_map_has_fewer_triangles_while_it_turns_and_all_at_rest(tmp_path):
    scripts = "".join(f"<script>{text}</script>" for text in (*viewer_scripts(), SQUARE))
    page = tmp_path / "square.html"
    page.write_text(f"<body><canvas style='width: 300px; height: 200px'></canvas>{scripts}")
    shown = subprocess.run(
        [BROWSER, *OPTIONS.split(), f"--user-data-dir={tmp_path / 'profile'}", page.as_uri()],
        capture_output=True, text=True, timeout=60, check=True,
    ).stdout  # fmt: skip
    told = json.loads(html.unescape(re.search(r'data-told="([^"]*)"', shown)[1]))
    whole = 2 * 28_800
    assert 4_000 < told["fewer"] < whole / 3
    assert told["area"] == pytest.approx(2 * 100**2, rel=2e-3)  # it covers the same faces
    assert told["lowest"] > 0  # and no triangle is turned over
    first, second = " ".join(map(str, told["drawn"])).split("rest")[:2]
    assert set(first.split()) == {str(whole)}
    assert second.split() == [str(told["fewer"]), str(whole)]
