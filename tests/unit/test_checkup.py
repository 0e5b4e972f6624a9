"""``vmach check`` finds all that a job lacks, not the first."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.small_job import (
    measurement,
    pocket_points,
    write_job,
    write_job_with_nominal,
    write_points,
)
from vmach.checkup import Weight, check_job, job_checkup
from vmach.cli import app

SAMPLES = Path(__file__).parents[2] / "samples"
MACHINE = SAMPLES / "iso10791_7" / "machine.toml"

JOB = """schema = 1
machine = "machine.toml"
program = "part.nc"
{extra}
[work_offsets_mm]
G54 = [-180, -310, -500]

[tools.1]
shape = "flat"
diameter_mm = 12
length_mm = 115
"""


def words(folder, weight=Weight.MEND):
    return [str(f) for f in check_job(folder) if f.weight is weight]


@pytest.fixture
def folder(tmp_path):
    shutil.copytree(MACHINE.parent, tmp_path / "m")
    (tmp_path / "job.toml").write_text(
        JOB.format(extra="").replace("machine.toml", "m/machine.toml")
    )
    (tmp_path / "part.nc").write_text(
        "G21 G90 G54 G0 X0 Y0 Z50\nT1 M6 G43 Z10\nG1 Z-1 F100\nX10\nM2\n"
    )
    return tmp_path


def test_a_right_job_lacks_nothing_and_says_what_it_assumes(folder):
    assert words(folder) == []
    assumed = "\n".join(words(folder, Weight.ASSUMED))
    for word in ("tool_offsets", "nominal", "[stock]", "tolerance"):
        assert word in assumed


def test_how_the_zero_was_set_is_asked_where_the_job_says_nothing(folder):
    job = folder / "job.toml"
    assert any("[probing]" in word for word in words(folder, Weight.ASSUMED))
    job.write_text(job.read_text() + "[probing]\n")
    (asked,) = [word for word in words(folder, Weight.ASSUMED) if "prob" in word]
    assert "is 115 mm long, as the first tool" in asked
    job.write_text(job.read_text() + "probe_length_mm = 80\n")
    assert not [word for word in words(folder, Weight.ASSUMED) if "prob" in word]


def test_every_fault_of_the_job_file_and_of_the_files_it_names(folder):
    text = JOB.format(extra='nominal = "part.step"\nspeed = 3')
    (folder / "job.toml").write_text(text.replace("= 12\n", '= "12"\n'))
    found = words(folder)
    assert len(found) == 4
    for word in ("unknown key 'speed'", "diameter_mm' = '12'", "machine = 'machine.toml': no such",
                 "nominal = 'part.step': no such file"):  # fmt: skip
        assert sum(word in line for line in found) == 1
    assert all("job.toml:" in line for line in found)


def test_all_that_a_program_needs_is_said_with_its_first_line(folder):
    (folder / "part.nc").write_text(
        "G21 G90 G55 G0 X0\nT7 M6\nG1 Z-1 F100\nT3 M6\nG1 X5\nG56 G1 X1\nM2\n"
    )
    found = words(folder)
    expected = ["part.nc:3: .*T7", "part.nc:5: .*T3", "part.nc:3: .*G55", "part.nc:6: .*G56"]
    for word in expected:
        line, _, what = word.partition(": .*")
        assert any(f"{line}: " in text and what in text for text in found), word
    assert any("workpiece_zero = one of G55, G56" in text for text in found)


def test_missing_tables_of_the_machine_are_all_named(folder):
    machine = folder / "m" / "machine.toml"
    text = machine.read_text()
    names = [line for line in text.splitlines() if line.startswith("table =")]
    assert names
    for path in (folder / "m").rglob("*.csv"):
        path.unlink()
    found = [text for text in words(folder) if "no such file" in text]
    assert len(found) == len(names)


def test_a_program_that_cannot_be_read_and_travel_that_is_left(folder):
    (folder / "part.nc").write_text("G21\nG999\n")
    assert any("part.nc:2" in text for text in words(folder))
    (folder / "part.nc").write_text("G21 G90 G54\nT1 M6 G43\nG0 X0 Y0 Z9\nG1 X5000 F100\nM2\n")
    assert any("outside the travel" in text for text in words(folder))


def test_the_command_prints_all_and_fails_where_something_is_to_mend(folder):
    run = CliRunner().invoke(app, ["check", str(folder)])
    assert run.exit_code == 0 and "0 to mend" in run.output
    (folder / "part.nc").unlink()
    run = CliRunner().invoke(app, ["check", str(folder), "--json"])
    assert run.exit_code == 1
    data = json.loads(run.output)
    assert data["ready"] is False
    assert [f["weight"] for f in data["findings"]] == ["mend"]


@pytest.mark.parametrize("text", ["", "a = [", "schema = 1\nmachine = 3", "\x00", "tools = 1"])
def test_no_job_file_is_too_broken_for_it(folder, text):
    (folder / "job.toml").write_text(text)
    assert words(folder)


def drawn(folder, old="", new=""):
    """The contouring test piece, with one change of its drawing; what is to be mended."""
    shutil.copytree(SAMPLES / "iso10791_7", folder, dirs_exist_ok=True)
    job = folder / "job.toml"
    text = job.read_text()
    assert old in text
    job.write_text(text.replace(old, new, 1))
    return words(folder)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"square +X" = "parallelism', '"square +X" = "perpendicularity',
         "91: tolerance 'perpendicularity 0.01 B': the CAD has an angle of 0 deg"),
        ('"square +X" =', '"square +Q" =', "91: no face and no point is called 'square +Q'"),
        ("angularity 0.01 B", "angularity 0.01 K", "datum K is not defined"),
        ('B = "square -X"', 'B = "square -W"', "83: datum B: no face and no point"),
        ('circle = ["roundness', 'circle = ["35 H7", "roundness', "which is 100 mm in the CAD"),
    ],
)  # fmt: skip
def test_a_drawing_without_sense_is_found_before_the_run(old, new, said, tmp_path):
    assert any(said in word for word in drawn(tmp_path, old, new))


def test_all_faults_of_a_drawing_are_told_at_once(tmp_path):
    """Two requirements of one feature, and one of a face that no tool makes."""
    both = '"centre hole" = ["35 H7", "parallelism 0.01 K", '
    found = drawn(tmp_path, '"centre hole" = [', '"face 5 plane" = "parallelism 0.01 C"\n' + both)
    assert len(found) == 3


def test_the_drawing_of_the_sample_has_sense(tmp_path):
    assert drawn(tmp_path) == []


def plain_job(folder, errors, more=""):
    """A pocket on a machine with some tables: component -> (curve, place, first position)."""
    job = write_job(folder, {name: (curve, at) for name, (curve, at) in errors.items()})
    machine = folder / "machine.toml"
    machine.write_text(machine.read_text() + more)
    return job


def test_displacements_without_a_place_are_named_with_their_line(tmp_path):
    """Roll of X turns EYX and EZX, not EXX."""
    curves = {name: (lambda x: 0.01 * x, None) for name in ("EXX", "EYX", "EAX")}
    job = plain_job(tmp_path, curves)
    job.write_text(job.read_text().replace("part.nc", "nowhere.nc"))
    (found,) = [f for f in check_job(job) if "measured_at_mm" in f.what]
    assert found.weight is Weight.MEND and "EYX has no measured_at_mm" in found.what
    line = (tmp_path / "machine.toml").read_text().splitlines()[found.line - 1]
    assert line == 'table = "errors/EYX.csv"'


def test_tables_that_are_missing_or_short_are_assumed_in_one_line_each(tmp_path):
    job = plain_job(tmp_path, {"EXX": (lambda x: 0.01 * x, None)})
    table = tmp_path / "errors" / "EXX.csv"
    head, *rows = table.read_text().splitlines()
    table.write_text("\n".join([head, *rows[5:]]))
    assumed = words(job, Weight.ASSUMED)
    (missing,) = [text for text in assumed if "no table, taken as zero" in text]
    assert "machine.toml: EYX EZX" in missing and "EXX" not in missing
    assert len([text for text in assumed if "positions beyond are refused" in text]) == 1
    assert words(job) == []


def test_every_table_that_ends_before_the_program_is_to_mend(tmp_path):
    curve = (lambda x: 0.01 * x, None)
    job = plain_job(tmp_path, {"EXX": curve, "EYX": curve, "EYY": curve})
    for name in ("EXX", "EYX"):
        table = tmp_path / "errors" / f"{name}.csv"
        head, *rows = table.read_text().splitlines()
        table.write_text("\n".join([head, *rows[22:]]))  # from -180 mm
    found = words(job)
    assert [text.split()[1] for text in found] == ["EXX", "EYX"]
    assert all("its table ends before" in text for text in found)


def test_a_part_that_stands_out_of_its_blank_is_to_mend_without_a_drawing(tmp_path):
    job = write_job_with_nominal(tmp_path)
    assert words(job) == []
    job.write_text(job.read_text().replace("min_mm = [-30,", "min_mm = [-20,"))
    (found,) = words(job)
    assert "out of the stock" in found


def test_what_run_lacks_without_cad_and_blank_is_said(folder):
    assumed = "\n".join(words(folder, Weight.ASSUMED))
    assert "'vmach run' has nothing to inspect" in assumed and "needs '--no-solid'" in assumed


def test_cad_is_read_once(monkeypatch):
    read, before = [], job_checkup.read_nominal

    def counted(*arguments):
        read.append(arguments)
        return before(*arguments)

    monkeypatch.setattr(job_checkup, "read_nominal", counted)
    assert words(SAMPLES / "iso10791_7") == []
    assert len(read) == 1


def test_what_is_doubtful_in_the_file_of_an_instrument_is_said(tmp_path):
    """Signs of approach that contradict the motion: `vmach diagnose` asks, and so does this."""
    job = write_job(tmp_path, more=measurement("laser", axis="X", at_mm=[-100, -100, -50]))
    places = [*range(-300, -50, 25), *range(-75, -301, -25)]
    rows = [f"1,{x},{-1 if k < 10 else 1},{5 * k},{k % 3}" for k, x in enumerate(places)]
    heading = "run,position_mm,approach,t_s,deviation_um"
    (tmp_path / "laser.csv").write_text("\n".join([heading, *rows]) + "\n")
    job.write_text(job.read_text().replace('measured = "points.csv"\n', ""))
    (asked,) = [word for word in words(tmp_path, Weight.LOOK) if "laser.csv" in word]
    assert str(tmp_path / "laser.csv") in asked and "are the signs exchanged?" in asked


def test_measured_points_that_the_program_does_not_cut_are_said(tmp_path):
    write_job(tmp_path)
    write_points(tmp_path / "points.csv")
    assert not [word for word in words(tmp_path, Weight.LOOK) if "points.csv" in word]
    _, points, _ = pocket_points()
    write_points(tmp_path / "points.csv", points + np.array([3.0, 0.0, 0.0]))
    (said,) = [word for word in words(tmp_path, Weight.LOOK) if "points.csv" in word]
    assert "the measured points are" in said or "from its nominal place" in said
