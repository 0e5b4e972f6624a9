"""A real browser opens the report, draws the map and shows the same figures."""

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
