"""What is refused leaves nothing behind; what is written is what is reported."""

import base64
import io
import json
import re

import pytest
from PIL import Image
from typer.testing import CliRunner

from tests.oracle.test_compensation_programs import SCALE, job_with
from tests.oracle.test_compensation_surface import AROUND, job_of_walls
from vmach.cli import app
from vmach.compensation import compensate
from vmach.errors import InputError

LINES = "G1 Z-1. F200\nX300.\nX-200.\nM30\n"


def run(folder, *arguments):
    out = folder / "out.nc"
    return CliRunner().invoke(app, ["compensate", str(folder), "-o", str(out), *arguments]), out


@pytest.mark.parametrize(
    ("body", "effects", "arguments", "line", "said"),
    [
        # 400 mm at 200 ppm: 80 um
        (LINES, SCALE, ["--limit-um", "79"], 9, "corrections up to 80.0 um"),
        # the travel ends at X1000, 900 from the work offset
        ("G1 Z-1. F200\nX900.\nM30\n", SCALE.replace("200", "-200"), [], 9, "outside the travel"),
        # half a step of 0.1 mm, and 20 um at X0 already
        (LINES, SCALE, ["--resolution-mm", "0.1"], 8, "um off its path"),
    ],
)
def test_refused_by_line_with_nothing_written(tmp_path, body, effects, arguments, line, said):
    job_with(tmp_path, body, effects)
    before = sorted(tmp_path.iterdir())
    result, _ = run(tmp_path, *arguments)
    assert isinstance(result.exception, InputError)
    assert said in str(result.exception)
    assert result.exception.line == line
    assert sorted(tmp_path.iterdir()) == before


def test_a_limit_that_is_kept_is_no_refusal(tmp_path):
    job, effects = job_with(tmp_path, LINES, SCALE)
    found = compensate(job, effects, limit_mm=0.081)
    assert found.largest_correction_mm == pytest.approx(0.08, abs=1e-4)


def test_rapids_at_the_end_of_the_travel_stay_there(tmp_path):
    body = "G1 Z-1. F200\nX300.\nG0 Z5.\nX900.\nM30\n"
    job, effects = job_with(tmp_path, body, SCALE.replace("200", "-200"))
    found = compensate(job, effects)
    assert b"X900." in found.text
    assert b"X300.08" in found.text


def test_the_report_has_the_figures_of_the_terminal(tmp_path):
    job_of_walls(tmp_path, SCALE)
    report = tmp_path / "report.html"
    result, out = run(tmp_path, "--report", str(report), "--json")
    assert result.exception is None, result.exception
    figures = json.loads(result.stdout)
    page = report.read_text(encoding="utf-8")
    assert out.read_bytes().startswith(b"(Odd Spacing )")
    assert f"{figures['after_largest_um']:.3f} µm" in page
    assert f"{figures['surface']['before_mean_um']:.3f} µm" in page
    assert "Before compensation" in page
    assert "After compensation" in page
    assert "deviations.csv" not in page, "a file that is not written"
    assert figures["surface"]["after_largest_um"] <= 0.9
    assert figures["growth"] == 1.0
    result, _ = run(tmp_path)
    assert f"{figures['before_largest_um']:.3f} um" in result.stdout


def test_the_report_holds_its_picture_and_comes_with_the_program_or_not_at_all(
    tmp_path, monkeypatch
):
    job_of_walls(tmp_path, SCALE)
    report = tmp_path / "report.html"
    result, out = run(tmp_path, "--report", str(report))
    assert result.exception is None, result.exception
    (picture,) = re.findall(r'src="data:image/jpeg;base64,([^"]+)"', report.read_text())
    with Image.open(io.BytesIO(base64.b64decode(picture))) as drawn:
        assert min(drawn.size) > 100
        assert len(drawn.getcolors(10**7)) > 100  # it is no empty sheet
    written, page = out.read_bytes(), report.read_bytes()

    def fails(*given, **named):
        raise InputError("no room")

    monkeypatch.setattr("vmach.compensation.report.write_report_html", fails)
    result, _ = run(tmp_path, "--report", str(report), "--resolution-mm", "0.01")
    assert isinstance(result.exception, InputError)
    assert (out.read_bytes(), report.read_bytes()) == (written, page)
    assert not list(tmp_path.glob("*.png"))


def test_a_report_needs_a_surface(tmp_path):
    job_with(tmp_path, AROUND, SCALE)
    result, out = run(tmp_path, "--report", str(tmp_path / "report.html"))
    assert isinstance(result.exception, InputError)
    assert "surface" in str(result.exception)
    assert not out.exists()
