"""Every command asks the same of the files that it reads, in the same words."""

from __future__ import annotations

import importlib
import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from vmach.base.note import Level
from vmach.cli import app
from vmach.errors import InputError
from vmach.job import read_job
from vmach.machine.machine import Axis
from vmach.path.levers import levers
from vmach.plausibility import Kind, admitted_machine, doubts, machine_notes
from vmach.plausibility.places import place_notes
from vmach.plausibility.table_values import value_notes

SAMPLE = Path(__file__).parents[2] / "samples" / "iso10791_7"
POINTS = "id,feature,x,y,z,i,j,k\n1,top,0,0,0,0,0,1\n2,top,20,0,0,0,0,1\n"
LINEAR = ("EXX", "EYX", "EZX", "EXY", "EYY", "EZY", "EXZ", "EYZ", "EZZ")


@pytest.fixture
def job(tmp_path) -> Path:
    """A copy of the sample with a short program, and points to predict."""
    folder = shutil.copytree(SAMPLE, tmp_path / "job")
    program = "G21 G90 G17 G54\nT2 M6\nS3200 M3\nG0 X-90 Y0\nG43 H2 Z5\nG1 Z-5 F900\nX90\nZ5\nM30\n"
    (folder / "part.nc").write_text(program)
    text = (folder / "job.toml").read_text().replace('nominal = "part.step"\n', "")
    (folder / "job.toml").write_text(text)
    (folder / "points.csv").write_text(POINTS)
    return folder / "job.toml"


def edit(path: Path, old: str, new: str, count: int = 1) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, count))


def scale_column(path: Path, column: int, factor: float) -> None:
    """Multiply a column of a table; its first line is a comment or the header."""
    lines = []
    for line in path.read_text().splitlines():
        cells = line.split(",")
        if re.match(r"\s*[-+\d.]", line):
            cells[column] = repr(float(cells[column]) * factor)
        lines.append(",".join(cells))
    path.write_text("\n".join(lines) + "\n")


def run(*arguments) -> str:
    """What a command says, on both streams; raises what it refuses."""
    result = CliRunner().invoke(app, [str(one) for one in arguments])
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    assert result.exit_code == 0, result.output
    return " ".join((result.output + result.stderr).split())


def commands(job: Path, out: Path) -> dict[str, list]:
    """A call of every command that a machine goes into."""
    machine, points = job.with_name("machine.toml"), job.with_name("points.csv")
    return {
        "path": ["path", job],
        "predict": ["predict", job, "--points", points],
        "compensate": ["compensate", job, "-o", out / "new.nc"],
        "tables": ["tables", job, "--format", "linuxcnc", "-o", out / "job_tables"],
        "tables of a machine": ["tables", "--machine", machine, "-o", out / "tables", "--format",
                                "linuxcnc"],
        "accuracy": ["accuracy", machine, "--grid", "3", "--json"],
    }  # fmt: skip


@pytest.mark.parametrize(
    ("old", "new", "accepted"),
    [
        ('length = "um"', 'length = "mm"', "1 mm at most"),
        ('angle = "urad"', 'angle = "mrad"', "0.01 rad at most"),
        ("EC0Y = 11.8", "EC0Y = 12500", "1 .. 5000 urad"),
        ("[-352.0, -214.0, -492.0]", "[-352000, -214000, -492000]", "-1260 .. 500 mm"),
    ],
)
def test_what_cannot_be_is_refused_by_every_command(job, tmp_path, old, new, accepted):
    edit(job.with_name("machine.toml"), old, new)
    said = set()
    for call in commands(job, tmp_path).values():
        with pytest.raises(InputError, match=re.escape(accepted)) as refused:
            run(*call)
        said.add(str(refused.value))
    assert len(said) == 1
    assert not any(tmp_path.glob("*tables")) and not (tmp_path / "new.nc").exists()


@pytest.mark.parametrize("call", [["compensate", "-o", "new.nc"], ["run"], ["diagnose"]])
def test_a_doubt_is_told_before_the_long_work(job, monkeypatch, call):
    edit(job.with_name("machine.toml"), "EC0Y = 11.8", "EC0Y = 299.72")
    command, *options = call
    monkeypatch.chdir(job.parent)
    work = {
        "compensate": ("vmach.compensation.compensate", "compensate"),
        "run": ("vmach.run.pipeline", "machine_part"),
        "diagnose": ("vmach.diagnosis.residuals.job_survey", "survey_job"),
    }

    def stop(*_, **__):
        raise InputError("the work has begun")

    module, name = work[command]
    monkeypatch.setattr(importlib.import_module(module), name, stop)
    result = CliRunner().invoke(app, [command, str(job), *options])
    assert str(result.exception) == "the work has begun"
    assert "before the work begins, a doubt" in result.stderr
    assert "doubt: EC0Y: a squareness of 299.7 urad" in result.stderr


def test_a_doubt_is_told_by_every_command_in_the_same_words(job, tmp_path):
    edit(job.with_name("machine.toml"), "EC0Y = 11.8", "EC0Y = 299.72")
    doubt = "doubt: EC0Y: a squareness of 299.7 urad; accepted: 1 .. 100 urad, or 0"
    for name, call in commands(job, tmp_path).items():
        assert doubt in run(*call), name
    assert doubt in (tmp_path / "tables" / "README.md").read_text()
    notes = json.loads((tmp_path / "job_tables" / "tables.json").read_text())["notes"]
    assert sum(doubt in note for note in notes) == 1
    assert "EC0Y" in (tmp_path / "new.nc").read_text()


FACTORS = (1e3, 25.4, 1 / 25.4, 1e-3)


def told_of(machine: Path) -> str:
    """The doubts that every command tells of a machine file, or what refuses it."""
    try:
        return " ".join(f"{note.subject}: {note.sentence}" for note in doubts_of(machine))
    except InputError as refused:
        return str(refused)


def doubts_of(machine: Path):
    return doubts(machine_notes(admitted_machine(machine)))


@pytest.mark.parametrize("factor", FACTORS)
@pytest.mark.parametrize("sample", ["iso10791_7", "mazak_ajv25", "spline_slot"])
def test_every_place_and_right_angle_in_another_unit_is_told(tmp_path, sample, factor):
    """Each number alone, in every machine of the samples, by what the file says of itself."""
    folder = shutil.copytree(SAMPLE.with_name(sample), tmp_path / "machine")
    machine = folder / "machine.toml"
    text = machine.read_text()
    assert not doubts_of(machine)
    numbers = re.compile(
        r"(?m)^(?:(?:measured_at|nose_at|stick_out)_mm = \[?|E[ABC]0[XYZ] = (?:\{ um_per_m = )?)"
        r"([-\d., ]*\d)"
    )
    silent = []
    for match in numbers.finditer(text):
        wrong = ", ".join(f"{float(x) * factor:.9g}" for x in match[1].split(","))
        machine.write_text(text[: match.start(1)] + wrong + text[match.end(1) :])
        if any(map(float, match[1].split(","))) and not told_of(machine):
            silent.append(match[0])
    assert not silent


@pytest.mark.parametrize("sample", ["iso10791_7", "mazak_ajv25", "spline_slot"])
def test_every_table_in_another_unit_is_told(sample):
    """The values of each table alone, in every machine of the samples that has all of a kind."""
    right = admitted_machine(SAMPLE.with_name(sample) / "machine.toml")
    for name, table in right.components.items():
        for factor in FACTORS:
            wrong = replace(table, forward=factor * table.forward, backward=factor * table.backward)
            told = value_notes(replace(right, components={**right.components, name: wrong}))
            assert {note.level for note in told} & {Level.REFUSED, Level.DOUBT}, (name, factor)


def test_the_middle_of_a_travel_about_zero_is_a_place(job):
    """Home in the middle: a reflector beside it stands in the middle of the table."""
    machine = job.with_name("machine.toml")
    component = read_job(job).machine.components["EXX"]
    there = replace(component, measured_at_mm=np.array([10.0, 5.0, -150.0]))
    whole = admitted_machine(machine)
    axes = {name: Axis(-380.0, 380.0) for name in "XYZ"}
    centred = replace(whole, axes=axes, components={"EXX": there})
    cornered = replace(whole, components={"EXX": replace(there, measured_at_mm=np.full(3, -12.0))})
    assert not [note for note in place_notes(centred)]
    assert [note.kind for note in place_notes(cornered)] == [Kind.PLACE]


@pytest.mark.parametrize("factor", [1e3, 25.4, 1 / 25.4, 1e-3])
@pytest.mark.parametrize("key", ["diameter_mm = 20", "length_mm = 130"])
def test_tools_in_another_unit_are_told(job, tmp_path, key, factor):
    name, value = key.split(" = ")
    edit(job, key, f"{name} = {float(value) * factor:.6g}")
    try:
        for call in (commands(job, tmp_path)[name] for name in ("path", "predict", "tables")):
            assert f"doubt: tool 2: {name} = " in run(*call)
    except InputError as refused:  # beyond the travel, or no tool at all
        assert factor > 1.0 or "tool 2" in str(refused)


ON_PARTS = ("run", "compare", "diagnose")


@pytest.mark.parametrize(
    "command", ["path", "predict", "compensate", "tables", "accuracy", *ON_PARTS]
)
def test_a_laser_and_a_ballbar_are_enough(job, tmp_path, command):
    """Positioning tables and squareness only, nobody said where the reflectors stood."""
    machine = job.with_name("machine.toml")
    text = machine.read_text()
    for name in LINEAR:
        text = re.sub(rf"(\[errors\.{name}\][^\[]*?)measured_at_mm = \[[^\]]*\]\n", r"\1", text)
    text = re.sub(r"\[errors\.E(?:[ABC].|XY|XZ|YX|YZ|ZX|ZY)\]\ntable = \S+\n", "", text)
    machine.write_text(text)
    assert "measured_at_mm" not in "".join(re.findall(r"^[^#].*$", text, re.M))
    assert re.findall(r"errors\.(E..)\]", text) == ["EXX", "EYY", "EZZ"]
    if command in ON_PARTS:  # what looks at a part has one to look at
        measured_part(job)
        run(command, job, "--out", tmp_path / "found")
    else:
        run(*commands(job, tmp_path)[command])


def measured_part(job: Path) -> None:
    """The slot that the program cuts, measured at its floor and its walls."""
    rows = ["id,feature,x,y,z,i,j,k,mx,my,mz,u_um"]
    for k, x in enumerate(np.linspace(-80.0, 80.0, 15)):
        for name, y, z, j, up in (("floor", 0.0, -5.0, 0, 1), ("wall", 10.0, -3.0, -1, 0)):
            place = f"{x:.3f},{y},{z}"
            rows.append(f"{name}{k},{name},{place},0,{j},{up},{place},1")
    job.with_name("points.csv").write_text("\n".join(rows) + "\n")
    edit(job, "program = ", 'measured = "points.csv"\nprogram = ')
    job.write_text(job.read_text().partition("[[features]]")[0])


def test_levers_of_a_laser_and_a_ballbar(job):
    """What diagnosis and uncertainty ask for: one unit of every component error, placed or not."""
    edit(job.with_name("machine.toml"), "measured_at_mm = [-352.0, -214.0, -492.0]\n", "")
    machine = read_job(job).machine
    alone = replace(machine, components={"EXX": machine.components["EXX"]})
    assert alone.unplaced == () and machine.unplaced == ("EXX",)
    found = levers(alone, np.zeros((1, 3)), np.array([[0.0, 0.0, -100.0]]))
    assert found["EBX"].shift_mm[0] == pytest.approx([-100.0, 0.0, 0.0])


def test_an_angle_about_its_own_direction_asks_for_no_place(job):
    """A roll turns about X: no point moves along X by it, so EXX needs no place."""
    edit(job.with_name("machine.toml"), "measured_at_mm = [-352.0, -214.0, -492.0]\n", "")
    machine = read_job(job).machine
    rolls = {name: machine.components[name] for name in ("EXX", "EAX")}
    assert replace(machine, components=rolls).unplaced == ()
    pitches = {name: machine.components[name] for name in ("EXX", "EBX")}
    assert replace(machine, components=pitches).unplaced == ("EXX",)


def test_positions_that_count_from_elsewhere(job):
    """Targets 0 .. 760 against a travel of -760 .. 0: refused; shifted by the file, the same."""
    machine, table = job.with_name("machine.toml"), job.parent / "errors" / "EXX.csv"
    as_it_was = run("path", job)
    lines = [
        ",".join([repr(float(line.split(",")[0]) + 760.0), *line.split(",")[1:]])
        if re.match(r"\s*[-+\d.]", line)
        else line
        for line in table.read_text().splitlines()
    ]
    table.write_text("\n".join(lines) + "\n")
    with pytest.raises(InputError, match=r"EXX: table 0 \.\. 760 mm, travel -760 \.\. 0") as no:
        run("path", job)
    assert "position_zero_mm = -760" in str(no.value) and "reverse = true" in str(no.value)
    assert "extrapolation" not in str(no.value)
    edit(machine, 'table = "errors/EXX.csv"', 'table = "errors/EXX.csv"\nposition_zero_mm = -760')
    assert run("path", job) == as_it_was


@pytest.mark.parametrize("counted", [False, True])
def test_positions_that_count_against_the_axis(job, counted):
    """The sample's table written mirrored by hand gives the same errors."""
    machine, table = job.with_name("machine.toml"), job.parent / "errors" / "EXX.csv"
    edit(machine, "[errors.EXX]", '[tables]\ndirections = "separate"\n\n[errors.EXX]')
    as_it_was = run("path", job)
    rows = np.loadtxt(table, delimiter=",", skiprows=1, comments="#")
    mirrored = rows * [-1.0, 1.0, 1.0]
    if counted:  # the instrument's coordinate is the axis' own with the other sign
        mirrored = np.column_stack([-rows[:, 0], -rows[:, 2], -rows[:, 1]])
    body = "\n".join(",".join(map(repr, row)) for row in mirrored.tolist())
    table.write_text("position_mm, forward, backward\n" + body + "\n")
    said = f"reverse = true\nreverse_deviations = {str(counted).lower()}"
    edit(machine, 'table = "errors/EXX.csv"', f'table = "errors/EXX.csv"\n{said}')
    assert run("path", job) == as_it_was


def test_which_way_deviations_count_has_to_be_said(job):
    machine, table = job.with_name("machine.toml"), job.parent / "errors" / "EXX.csv"
    scale_column(table, 0, -1.0)
    edit(machine, 'table = "errors/EXX.csv"', 'table = "errors/EXX.csv"\nreverse = true')
    assert "accepted: reverse_deviations = true or false" in run("path", job)


@pytest.mark.parametrize("factor", [1e3, 25.4, 1 / 25.4, 1e-3])
def test_positions_in_another_unit(job, factor):
    machine = job.with_name("machine.toml")
    edit(machine, 'table = "errors/EYY.csv"', 'table = "errors/EYY.csv"\nextrapolation = "hold"')
    scale_column(job.parent / "errors" / "EYY.csv", 0, factor)
    if factor > 1.0:
        with pytest.raises(InputError, match=r"EYY: table .* the axis was never there"):
            run("path", job)
    else:
        assert "doubt: EYY: table" in run("path", job)


def test_one_row_far_out(job):
    table = job.parent / "errors" / "EYY.csv"
    lines = table.read_text().splitlines()
    cells = lines[-1].split(",")
    table.write_text("\n".join([*lines[:-1], ",".join(["-1e9", *cells[1:]])]) + "\n")
    with pytest.raises(InputError, match=r"EYY: .*one row not a slip"):
        run("path", job)


@pytest.mark.parametrize("factor", [1e3, 25.4, 1 / 25.4, 1e-3])
@pytest.mark.parametrize("name", ["EXX", "EYX", "EBY"])
def test_values_in_another_unit(job, factor, name):
    table = job.parent / "errors" / f"{name}.csv"
    for column in (1, 2):
        scale_column(table, column, factor)
    try:
        assert f"doubt: {name}: " in run("path", job)
    except InputError as refused:
        assert f"{name}.csv" in str(refused) and "unit" in str(refused)
