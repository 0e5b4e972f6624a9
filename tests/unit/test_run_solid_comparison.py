"""The virtual part against the CAD in what ``vmach run`` prints and writes."""

import pytest
import trimesh

from tests.report_case import large_mesh, points, run
from tests.small_job import MACHINE
from vmach.machine import Variant
from vmach.report import (
    SolidComparison,
    SolidDifference,
    differences_text,
    summary,
    write_report_html,
)
from vmach.run.pipeline import machine_part

STEP_MM = 2.0

JOB = """\
schema = 1
machine = "machine.toml"
program = "part.nc"
nominal = "part.stl"
[work_offsets_mm]
G54 = [-200, -150, -200]
[stock]
min_mm = [0, 0, -10]
max_mm = [40, 20, 0]
[tools.1]
shape = "flat"
diameter_mm = 10
length_mm = 100
"""

PROGRAM = """\
T1 M6
S6000 M3
G54 G43 H1
G0 X-10 Y0 Z5
G1 Z{z} F300
G1 X50 F900
G0 Z5
M30
"""


def shoulder_job(folder, cut_mm):
    """A shoulder of 5 x 2 mm in the CAD, cut to another depth by line 6."""
    body = trimesh.creation.box(bounds=[[0, 0, -10], [40, 20, 0]])
    shoulder = trimesh.creation.box(bounds=[[-1, -1, -STEP_MM], [41, 5, 1]])
    trimesh.boolean.difference([body, shoulder], engine="manifold").export(folder / "part.stl")
    (folder / "machine.toml").write_text(MACHINE)
    (folder / "part.nc").write_text(PROGRAM.format(z=-cut_mm))
    (folder / "job.toml").write_text(JOB)
    return folder / "job.toml"


@pytest.mark.parametrize(("cut_mm", "kind"), [(1.7, "excess"), (2.3, "gouge")])
def test_a_shoulder_cut_to_the_wrong_depth_is_listed_with_its_line(tmp_path, cut_mm, kind):
    made = machine_part(shoulder_job(tmp_path, cut_mm), variants=(Variant.NONE,))
    assert made.comparison.count == 1
    (place,) = made.comparison.places
    assert place.kind == kind
    assert abs(place.depth_mm) == pytest.approx(0.3, abs=1e-4)
    assert (place.line, place.tool) == (6, 1)
    assert place.volume_mm3 == pytest.approx(40 * 5 * 0.3, rel=0.02)
    assert place.area_mm2 == pytest.approx(40 * 5 + 40 * 0.2, rel=0.15)
    assert any("in 1 place " in str(note) for note in made.notes)


def test_a_part_as_drawn_has_no_difference(tmp_path):
    made = machine_part(shoulder_job(tmp_path, STEP_MM), variants=(Variant.NONE,))
    assert made.comparison.places == ()
    assert not any("differs from the nominal CAD" in str(note) for note in made.notes)


def test_the_page_lists_the_places(tmp_path):
    place = SolidDifference(-0.5, (1, 2, 3), (4, 5, 6), 7.0, 8.0, "face <1> plane", 2, 3)
    record = run(comparison=SolidComparison(0.1, 1, (place,)))
    names = [column.name for column in points().with_remainders().columns]
    write_report_html(tmp_path / "report.html", large_mesh(200, names), points(), record)
    page = (tmp_path / "report.html").read_text()
    assert '<table id="differences">' in page
    assert "<td>gouge</td>" in page
    assert "face &lt;1&gt; plane" in page
    assert "<code>N2 G1 X2</code>" in page


def test_many_places_are_counted_and_the_stock_is_named():
    one = SolidDifference(0.5, (1, 2, 3), (4, 5, 6), 7.0, float("nan"), "face 1 plane", 0, 0)
    record = run(comparison=SolidComparison(0.1, 12, (one,) * 12))
    lines = differences_text(record)
    assert len(lines) == 1 + 8 + 1
    assert "surface of the stock" in lines[1]
    assert "nan" not in lines[1]
    assert lines[-1].strip() == "... 4 more in summary.json"
    figures = summary(points(), record)["differences"]
    assert figures["places"][0]["volume_mm3"] is None
