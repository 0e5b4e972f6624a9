"""One thing wrong in the files of an experiment: the note names the file and what to look at."""

import re
import shutil

import pytest

from tests.hidden_effects.experiment import make_experiment
from vmach.base.note import Kind
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.errors import InputError
from vmach.instruments import read_instruments
from vmach.job import read_job

TESTS = ("ballbar_xy", "laser_X", "laser_Y", "laser_Z", "diagonal_0", "drift", "tip")


@pytest.fixture(scope="module")
def worn(tmp_path_factory):
    """A machine with lost motion of 11 um in X and a test of every kind."""
    folder = tmp_path_factory.mktemp("worn")
    make_experiment(folder, effects=["backlash"], seed=61, instruments=TESTS)
    return folder


@pytest.fixture(scope="module")
def healthy(tmp_path_factory):
    folder = tmp_path_factory.mktemp("healthy")
    make_experiment(folder, effects=[], seed=62, instruments=TESTS)
    return folder


def notes_of_tests(folder):
    tests = read_instruments(read_job(folder / "job.toml"))
    return [str(note) for test in tests for note in test.notes]


def edit_section(folder, name, pattern, value):
    """Change the section of one test in the job."""
    path = folder / "job.toml"
    sections = path.read_text().split("[[measurements]]")
    (k,) = (k for k, text in enumerate(sections) if f'"{name}.csv"' in text)
    sections[k], count = re.subn(pattern, value, sections[k])
    assert count == 1
    path.write_text("[[measurements]]".join(sections))


def edit_columns(folder, name, change, *columns):
    """Change numbers in columns of a test's file."""
    path = folder / f"{name}.csv"
    header, *rows = path.read_text().splitlines()
    places = [header.split(",").index(column) for column in columns]
    cells = [row.split(",") for row in rows]
    for row in cells:
        for k in places:
            row[k] = f"{change(float(row[k])):.9g}"
    path.write_text("\n".join([header, *map(",".join, cells)]) + "\n")


def edit_tools(folder, key, factor, numbers=(1, 2)):
    """Give a dimension of tools in another unit."""
    path = folder / "job.toml"
    for number in numbers:
        text = path.read_text()
        pattern = rf"(\[tools\.{number}\][^\[]*?\n{key} = )([\d.]+)"
        changed, count = re.subn(pattern, lambda m: f"{m[1]}{float(m[2]) * factor:.9g}", text)
        assert count == 1
        path.write_text(changed)


@pytest.mark.parametrize("machine", ["worn", "healthy"])
def test_what_is_right_is_not_asked_about(machine, request):
    survey = survey_job(request.getfixturevalue(machine) / "job.toml")
    asked = [note for m in survey.measurements for note in m.notes]
    assert [note for note in asked if note.kind is not Kind.CONTROL] == []


@pytest.mark.parametrize(
    ("name", "columns"),
    [("laser_X", ["approach"]), ("diagonal_0", ["approach"]), ("tip", ["sx", "sy", "sz"])],
)
def test_exchanged_approaches(worn, tmp_path, name, columns):
    folder = shutil.copytree(worn, tmp_path / "job")
    edit_columns(folder, name, lambda sign: -sign, *columns)
    (note,) = notes_of_tests(folder)
    assert note.startswith(f"{name}.csv: ") and "are the signs exchanged?" in note


def test_lost_motion_the_wrong_way_round(worn, tmp_path):
    """Readings of the two directions exchanged, the places visited in their right order."""
    folder = shutil.copytree(worn, tmp_path / "job")
    path = folder / "laser_X.csv"
    header, *rows = path.read_text().splitlines()
    cells = [row.split(",") for row in rows]
    names = header.split(",")
    place, way, seen = (names.index(n) for n in ("position_mm", "approach", "deviation_um"))
    by_place = {(row[0], row[place], float(row[way])): row[seen] for row in cells}
    for row in cells:
        row[seen] = by_place[row[0], row[place], -float(row[way])]
    path.write_text("\n".join([header, *map(",".join, cells)]) + "\n")
    (note,) = notes_of_tests(folder)
    assert re.search(r"laser_X\.csv: approached with 1 the axis stops 1[01]\.\d um further", note)


@pytest.mark.parametrize(("was", "said"), [("Y", "X"), ("Z", "Y"), ("Z", "X")])
def test_a_line_of_another_axis(healthy, tmp_path, was, said):
    folder = shutil.copytree(healthy, tmp_path / "job")
    edit_section(folder, f"laser_{was}", f'axis = "{was}"', f'axis = "{said}"')
    (note,) = notes_of_tests(folder)
    assert note.startswith(f'laser_{was}.csv: with axis = "{was}" the readings would agree')
    assert note.endswith(f"is axis = {said} in the job right?")


def test_a_circle_whose_axes_are_exchanged(healthy, tmp_path):
    folder = shutil.copytree(healthy, tmp_path / "job")
    edit_section(folder, "ballbar_xy", 'plane = "XY"', 'plane = "YX"')
    (note,) = notes_of_tests(folder)
    assert 'ballbar_xy.csv: with plane = "XY"' in note


def test_angles_that_run_the_other_way(healthy, tmp_path):
    folder = shutil.copytree(healthy, tmp_path / "job")
    edit_columns(folder, "ballbar_xy", lambda angle: (360.0 - angle) % 360.0, "angle_deg")
    (note,) = notes_of_tests(folder)
    assert "does angle_deg count from X towards Y?" in note


@pytest.mark.parametrize(("length", "unit"), [("0.18", "metres"), ("7.087", "inches")])
def test_the_length_to_the_reflector_in_another_unit(healthy, tmp_path, length, unit):
    folder = shutil.copytree(healthy, tmp_path / "job")
    edit_section(folder, "laser_X", r"tool_length_mm = \d+", f"tool_length_mm = {length}")
    doubt, *seen = notes_of_tests(folder)
    assert f"laser_X.csv: tool_length_mm = {length}" in doubt and f"is it in {unit}?" in doubt
    assert "with tool_length_mm = 180" in seen[0]


@pytest.mark.parametrize("name", ["laser_X", "tip", "drift"])
def test_times_in_minutes(healthy, tmp_path, name):
    folder = shutil.copytree(healthy, tmp_path / "job")
    edit_columns(folder, name, lambda time: time / 60.0, "t_s")
    (note,) = notes_of_tests(folder)
    assert note.startswith(f"{name}.csv: ") and note.endswith("is t_s in seconds?")


@pytest.mark.parametrize(
    ("key", "factor", "question"),
    [
        ("length_mm", 1e-3, "is length_mm = 0.15, 0.105 of tools 1, 2 in metres?"),
        ("diameter_mm", 1e-3, "is diameter_mm = 0.02, 0.012 of tools 1, 2 in metres?"),
        (
            "diameter_mm",
            1 / 25.4,
            "is diameter_mm = 0.787402, 0.472441 of tools 1, 2 in inches?",
        ),
    ],
)
def test_tools_in_another_unit_are_refused_by_their_name(healthy, tmp_path, key, factor, question):
    folder = shutil.copytree(healthy, tmp_path / "job")
    edit_tools(folder, key, factor)
    with pytest.raises(InputError, match=rf"the program cuts \d+ of.*{re.escape(question)}"):
        survey_job(folder / "job.toml")


@pytest.mark.parametrize(
    ("key", "factor", "question"),
    [
        ("length_mm", 1 / 25.4, "is length_mm = 4.13386 of tool 2 in inches?"),
        ("diameter_mm", 1 / 25.4, "is diameter_mm = 0.472441 of tool 2 in inches?"),
        ("diameter_mm", 0.5, "is diameter_mm = 6 of tool 2 the radius?"),
    ],
)
def test_one_tool_in_another_unit_is_asked_about(healthy, tmp_path, key, factor, question):
    folder = shutil.copytree(healthy, tmp_path / "job")
    edit_tools(folder, key, factor, numbers=(2,))
    notes = [str(note) for m in survey_job(folder / "job.toml").measurements for note in m.notes]
    assert any(note.endswith(f"so many: {question}") for note in notes)
    if key == "length_mm":
        assert any("tool 2: length_mm = 4.13386, from spindle nose to tip" in n for n in notes)
