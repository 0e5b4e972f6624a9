"""The drawing of a job: values that follow from a scale error of X, shares, lines, verdicts."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
import trimesh

from tests.small_job import PROGRAM, pocket_points, write_job, write_points
from vmach.commands.machining import compare
from vmach.errors import InputError
from vmach.features.evaluation import evaluate
from vmach.features.feature import Points
from vmach.features.verdict import Verdict
from vmach.job import read_job
from vmach.nominal import read_nominal
from vmach.run.drawing import job_drawing
from vmach.run.pipeline import inspect_part

#: X moves 100 ppm too far; the reflector stood at the tip's height
STRETCH = {"EXX": (lambda x: 0.1 * x, (0, 0, -100))}
DRAWING = """
[[features]]
name = "width"
faces = ["wall +X", "wall -X"]

[datums]
A = "wall -X"
B = "floor"

[tolerances]
width = ["40 ±0.01", "40 +0.002 0"]
bore = ["roundness 0.01", "distance 20 ±0.01 to wall +X", "12 H7"]
"wall +X" = ["parallelism 0.01 A", "perpendicularity 0.01 B"]
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    job = write_job(tmp_path_factory.mktemp("job"), STRETCH, more=DRAWING)
    results = inspect_part(job, prefer_measured=True).features
    return {(r.feature, r.callout, r.label): r for r in results}


def value(found, *key):
    key = key if len(key) == 3 else (*key, "")
    return found[key].predicted.value_mm


def test_the_pocket_is_longer_by_its_path_not_by_its_width(found):
    """The path is 30 mm long; the tool's 10 mm do not stretch."""
    for label in ("smallest", "largest"):
        assert value(found, "width", "40 ±0.01", label) == pytest.approx(40.003, abs=1e-6)


def test_the_bore_becomes_an_ellipse(found):
    """The tool's centre goes round on 1 mm: 0.1 um more in X than in Y."""
    assert value(found, "bore", "roundness 0.01") == pytest.approx(1e-4, rel=0.05)


def test_the_bore_stands_off_the_wall(found):
    """It moves by 40 mm times 1e-4, the wall by the 15 mm of its path."""
    found_mm = value(found, "bore", "distance 20 ±0.01 to wall +X")
    assert found_mm == pytest.approx(20.0025, abs=2e-6)


def test_the_scale_is_all_of_it(found):
    result = found["width", "40 ±0.01", "largest"]
    assert result.shares[0].source == "EXX"
    assert result.shares[0].share_mm == pytest.approx(0.003, abs=1e-6)
    assert result.cause == "100 % EXX"


def test_lines_are_those_of_the_walls(found):
    lines = {one.line for one in found["width", "40 ±0.01", "largest"].lines}
    program = PROGRAM.splitlines()
    assert {program[n - 1].split()[0] for n in lines} <= {"X15", "X-15", "Y10", "Y-10"}


def test_verdicts_of_prediction_and_measurement(found):
    """0.003 mm too wide for +0.002; measured as nominal, on the limit, which proves nothing."""
    result = found["width", "40 +0.002 0", "largest"]
    assert result.predicted.verdict is Verdict.FAILS
    assert result.measured.value_mm == pytest.approx(40.0, abs=1e-9)
    assert result.measured.u_mm == pytest.approx(0.0005 * 2**0.5)
    assert result.measured.verdict is Verdict.OPEN


def test_compare_writes_table_and_json(tmp_path, capsys):
    job = write_job(tmp_path, STRETCH, more=DRAWING)
    compare(job, out=tmp_path / "out", as_json=True)
    figures = json.loads(capsys.readouterr().out)
    one = figures["features"][1]
    assert (one["feature"], one["label"]) == ("width", "largest")
    assert one["values"]["abbe"]["value_mm"] == pytest.approx(40.003, abs=1e-6)
    assert one["values"]["measured"]["u_um"] == pytest.approx(0.7071, abs=1e-4)
    assert one["shares_um"]["EXX"] == pytest.approx(3.0, abs=1e-3)
    with (tmp_path / "out" / "features.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(figures["features"])
    assert rows[1]["predicted_mm"] == "40.003000"
    page = (tmp_path / "out" / "report.html").read_text()
    assert 'id="drawing"' in page and "parallelism 0.01 A" in page


STEP = '[[features]]\nname = "step"\nfaces = "floor"\n'
REFUSED = [
    ('[tolerances]\nbroe = "12 H7"', "no face and no point is called 'broe'; accepted: .*'bore'"),
    ('[tolerances]\nbore = "12 H77"', r"job.toml:\d+: tolerance grade IT77"),
    ('[tolerances]\nbore = "round 0.1"', r"job.toml:\d+: tolerance 'round 0.1'; accepted"),
    ('[datums]\nAB = "floor"', r"job.toml:\d+: datum 'AB'; accepted: one capital letter"),
    ('[tolerances]\nbore = "position Ø0.1 A"', "'position Ø0.1 A' of 'bore': datum A is not"),
    ('[tolerances]\n"wall *" = "40 H7"', "has no size"),
    ('[datums]\nA = "floor"\n[tolerances]\nbore = "coaxiality Ø0.1 A"', "about one axis"),
    ('[tolerances]\nbore = "13 H7"', "'bore', which is 12 mm in the CAD"),
    (STEP + '[tolerances]\nstep = "distance 0 ±0.1 to step"',
     r"job.toml:\d+: tolerance 'distance 0 ±0.1 to step' of 'step' is a distance to itself; "
     r"accepted: .*hint: the size"),
    ('[tolerances]\nbore = "12 ±0.1 to floor"',
     r"job.toml:\d+: tolerance '12 ±0.1 to floor': a size .*accepted: .*'distance 40"),
    (STEP + '[tolerances]\nstep = "distance 0 ±0.1 to floor"',
     r"job.toml:\d+: .* is a distance to 'floor', which has the same faces; accepted: the name"),
    ('[datums]\nC = "floor"\n[tolerances]\n"wall +X" = "perpendicularity 0.1 C-C"',
     r"job.toml:\d+: .*: datum 'C-C' has the letter C twice; accepted: .*hint: C alone"),
    ('[[features]]\nname = "a"\n[[features]]\nname = "a"', "two features are called 'a'"),
    ('[drawing]\nlogo = "none.png"', "accepted: a PNG or JPEG file that is there"),
    ('[drawing]\nassociation = "best"', "'drawing.association' = 'best'"),
    ('[datums]\nA = "wall -X"\nB = "wall +X"\n[tolerances]\nbore = "position Ø0.1 A B"',
     "datum B locks nothing"),
]  # fmt: skip


@pytest.mark.parametrize(("more", "message"), REFUSED)
def test_mistakes_are_named(tmp_path, more, message):
    with pytest.raises(InputError, match=message):
        inspect_part(write_job(tmp_path, more="\n" + more + "\n"), prefer_measured=True)


def write_stl_with_bore(folder):
    """The blank with the bore alone, of 720 facets; every point keeps to the cylinder."""
    block = trimesh.creation.box(bounds=[(-30, -25, -20), (60, 25, 0)])
    bore = trimesh.creation.cylinder(radius=6.0, segment=[(40, 0, -6), (40, 0, 5)], sections=720)
    trimesh.boolean.difference([block, bore], engine="manifold").export(folder / "part.stl")


@pytest.mark.parametrize("callout", ["12 H7", "roundness 0.01", "straightness Ø0.01"])
def test_a_bore_of_an_stl_is_what_the_job_says(tmp_path, callout):
    """Facets name no surface; the hint of the refusal is what mends it."""
    write_stl_with_bore(tmp_path)
    nominal = read_nominal(tmp_path / "part.stl")
    points = nominal.sample(1.0, edge_margin_mm=0.3)
    (face,) = [face.name for face in nominal.faces if "curved" in face.name]
    entry = f'[[features]]\nname = "hole"\nfaces = "{face}"\n'
    asked = f'[tolerances]\nhole = "{callout}"\n'
    with pytest.raises(InputError) as caught:
        measured_hole(write_job(tmp_path, more=entry + asked), nominal, points)
    assert 'say kind = "cylinder"' in caught.value.hint
    found = measured_hole(
        write_job(tmp_path, more=f'{entry}kind = "cylinder"\n{asked}'), nominal, points
    )
    assert found == pytest.approx(12.0 if callout == "12 H7" else 0.0, abs=2e-3)


def measured_hole(job, nominal, points):
    """The first value of the drawing on a part that is as nominal."""
    drawing = job_drawing(read_job(job), nominal, points)
    exact = Points.nominal(points.point_mm, points.normal)
    return evaluate(drawing, drawing.requirements[0], exact)[0].value_mm


def test_a_job_without_tolerances_loads_nothing_of_it(tmp_path):
    assert inspect_part(write_job(tmp_path), prefer_measured=True).features == ()


#: the same part in other units, and another part, with what has to be said of each
OF_ANOTHER_KIND = {
    "a scan in inches": (lambda p: p / 25.4, "look like inches.*accepted: all coordinates in mm"),
    "another part": (lambda p: p * [1.5, 0.7, 1.0] + [3.0, 1.0, 0.0],
                     "accepted: measured points within 0.5 mm .*measurement of this part"),
    "another zero": (lambda p: p + np.array([10.0, 0.0, 0.0]),
                     r"shifted by \(10.000, 0.000, 0.000\) mm"),
}  # fmt: skip


@pytest.mark.parametrize("name", list(OF_ANOTHER_KIND))
def test_a_report_of_something_else_is_refused(tmp_path, name):
    change, message = OF_ANOTHER_KIND[name]
    job = write_job(tmp_path, more=DRAWING)
    write_points(tmp_path / "points.csv", change(pocket_points()[1]))
    with pytest.raises(InputError, match=r"points\.csv.*" + message):
        inspect_part(job, prefer_measured=True)
