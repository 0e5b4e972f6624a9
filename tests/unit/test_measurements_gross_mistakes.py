"""A tool or a work offset that is wrong by far is named, against parts written out here."""

import re

import numpy as np
import pytest

from tests.small_job import PROGRAM, pocket_points, write_job, write_points
from vmach.errors import InputError
from vmach.instruments import measure_part
from vmach.job import read_job
from vmach.path.preparation import prepare

NAMES, POINTS, NORMALS = pocket_points()
IS_BORE, IS_FLOOR = NAMES == "bore", NAMES == "floor"
WALL = NORMALS[:, 2] == 0.0


def refusal_of(folder, away_mm, program, more=""):
    """What is said of points that lie `away_mm` (P,) along their normals."""
    job = write_job(folder)
    (folder / "part.nc").write_text(program)
    text = job.read_text().replace("[stock]", f"{more}\n[stock]")
    job.write_text(text.replace("schema = 1", 'schema = 1\nworkpiece_zero = "G54"'))
    write_points(folder / "points.csv", POINTS + away_mm[:, None] * NORMALS)
    with pytest.raises(InputError) as refused:
        measure_part(prepare(read_job(job)), folder / "points.csv")
    return refused.value.hint


#: the bore is cut by a tool of its own, or in another set-up
BY_TOOL_2 = PROGRAM.replace("G0 X40 Y0\n", "G0 Z50\nT2 M6\nG43 H2\nG0 X40 Y0\nG0 Z5\n")
IN_G55 = PROGRAM.replace("G0 X40 Y0\n", "G55\nG0 X40 Y0\n")
G55 = "G55 = [-200, -150, -200]"


@pytest.fixture
def two_tools(monkeypatch):
    """The second tool as large as the first."""
    from tests import small_job

    tool = '[tools.2]\nshape = "flat"\ndiameter_mm = 10\nlength_mm = 100\n'
    monkeypatch.setattr(small_job, "JOB", small_job.JOB + tool)


@pytest.mark.usefixtures("two_tools")
def test_a_tool_of_another_diameter_is_named(tmp_path):
    hint = refusal_of(tmp_path, np.where(IS_BORE, -1.0, 0.0), BY_TOOL_2)
    assert hint.startswith("the part is as if tool 2 were 2.000 mm larger in diameter: is it that")


@pytest.mark.usefixtures("two_tools")
def test_a_tool_of_another_diameter_and_length_is_named(tmp_path):
    away = np.where(IS_FLOOR, -3.0, np.where(WALL & ~IS_BORE, -1.0, 0.0))
    hint = refusal_of(tmp_path, away, BY_TOOL_2)
    assert "tool 1 were 2.000 mm larger in diameter" in hint


@pytest.mark.usefixtures("two_tools")
@pytest.mark.parametrize(("mm", "said"), [(1.5, "still in the points"), (-1.5, "taken off twice")])
def test_the_radius_of_the_probe_is_asked_about(tmp_path, mm, said):
    """All surfaces lie out by the same: it takes two wrong tools, and a probe does it alone."""
    hint = refusal_of(tmp_path, np.full(len(POINTS), mm), BY_TOOL_2)
    assert f"the radius of the measuring probe {said}? Every surface lies 1.500 mm" in hint


@pytest.mark.usefixtures("two_tools")
def test_two_tools_that_are_exchanged_are_named(tmp_path, monkeypatch):
    from tests import small_job

    other = small_job.JOB.replace("diameter_mm = 10\nlength_mm = 100\n", "diameter_mm = 12\n"
                                  "length_mm = 100\n", 1)  # fmt: skip
    monkeypatch.setattr(small_job, "JOB", other)
    program = BY_TOOL_2
    # predicted: walls 1 mm deeper than nominal; made by the tool of 10 mm, the bore by that of 12
    away = np.where(IS_BORE, -1.0, 0.0)
    hint = refusal_of(tmp_path, away, program)
    assert "tool 1 were 2.000 mm smaller" in hint and "tool 2 were 2.000 mm larger" in hint
    assert hint.endswith("were the two exchanged?")


def test_a_work_offset_is_named(tmp_path):
    away = np.where(IS_BORE, NORMALS @ [2.0, -1.5, 0.0], 0.0)
    hint = refusal_of(tmp_path, away, IN_G55, G55)
    x, y, _ = re.search(r"what was cut in G55 lies \((.*)\) mm away", hint)[1].split(", ")
    # the floor's points lie on a line: a turn about it takes a little of the shift
    assert (float(x), float(y)) == pytest.approx((2.0, -1.5), abs=0.05)
    assert hint.endswith("is this work offset right?")


def test_of_what_has_no_single_cause_none_is_named(tmp_path):
    away = np.where(IS_BORE, np.random.default_rng(5).normal(size=len(NAMES), scale=2.0), 0.0)
    hint = refusal_of(tmp_path, away, IN_G55, G55)
    assert not {"tool", "G54", "G55"} & set(hint.split())
