"""[control] of a job and --control: which control reads the program, and what is said about it."""

import pytest

from gcode import ProgramError
from tests.golden.test_bad_input import run_vmach
from tests.small_job import write_job
from vmach.base.note import Kind, Level
from vmach.checkup import Weight, check_job
from vmach.errors import InputError
from vmach.job import read_job
from vmach.job.control import tell_control
from vmach.path.preparation import prepare

CONTROL = """[control]
name = "haas"
increment = "IS-B"
block_delete = [1, 2]
ignore_m = [131]
"""


@pytest.fixture(autouse=True)
def nothing_told():
    yield
    tell_control(None)


def test_switches_reach_the_reader(tmp_path):
    job = write_job(tmp_path, more=CONTROL)
    (tmp_path / "part.nc").write_text(
        "%\nO1\nT1 M6\nM131\nG54 G43 H1 G0 X0. Y0. Z5.\n/2 X9.\nG1 X5000 F500.\nM30\n%\n"
    )
    found = prepare(read_job(job))
    assert found.program.dialect == "haas"
    assert found.program.moves.end_mm[-1, 0] == pytest.approx(-200 + 5.0)
    assert str(found.notes[0]) == "part.nc is read as Haas NGC (haas): as told"


def test_what_was_recognised_is_the_first_line(tmp_path):
    job = write_job(tmp_path)
    path = tmp_path / "part.nc"
    path.write_text(path.read_text().replace("M30", "IF[#1EQ1]GOTO9\nN9 M30"))
    said = "part.nc is read as FANUC Series 0i and 30i (fanuc): 'IF[#1EQ1]GOTO' in line 25"
    assert str(prepare(read_job(job)).notes[0]) == said


def test_numbers_without_a_point_are_noted(tmp_path):
    job = write_job(tmp_path, more='[control]\nname = "fanuc"\n')
    assert "no decimal point" in str(prepare(read_job(job)).notes[1])


def test_the_command_line_comes_first(tmp_path, monkeypatch, capsys):
    job = write_job(tmp_path)
    for name, expected in (("haas", "part.nc is read as Haas"), ("auto", "read as LinuxCNC")):
        arguments = ("path", job, "-o", tmp_path / f"{name}.csv", "--control", name)
        _, out, message = run_vmach(monkeypatch, capsys, *arguments)
        assert expected in out + message
    arguments = ("path", job, "-o", "x.csv", "--control", "x")
    status, _, message = run_vmach(monkeypatch, capsys, *arguments)
    assert (status, "--control x; accepted: auto, centroid, fanuc" in message) == (1, True)


def test_two_names_are_refused(tmp_path):
    job = write_job(tmp_path, more=CONTROL)
    job.write_text(job.read_text().replace("measured", 'dialect = "fanuc"\nmeasured', 1))
    with pytest.raises(InputError, match="and \\[control\\] name = 'haas'"):
        read_job(job)


def test_a_check_asks_what_numbers_without_a_point_count(tmp_path):
    for more, asked in (("", 1), ('increment = "IS-B"\n', 0)):
        job = write_job(tmp_path, more=f'[control]\nname = "fanuc"\n{more}')
        found = [f for f in check_job(job) if "no decimal point" in f.what]
        assert len(found) == asked
        assert all(f.weight is Weight.LOOK and "IS-C" in f.accepted for f in found)


def test_options_of_a_control_reach_its_reader(tmp_path):
    options = '[control]\nname = "fanuc"\noptions = { start_up = "B" }\n'
    job = read_job(write_job(tmp_path, more=options))
    assert job.control.options == {"start_up": "B"}
    wrong = read_job(write_job(tmp_path, more=options.replace('"B"', '"C"')))
    with pytest.raises(ProgramError, match="options: start_up = 'C'; accepted: A, B"):
        prepare(wrong)


@pytest.mark.parametrize(
    "lines, says, level",
    [
        ("G21 M30\n%\n", None, None),
        ("M30\n%\n", "neither G20 nor G21", Level.NOTE),
        ("G21 G0 X-4.", "is the file cut short?", Level.QUESTION),
        ("G21\nG154 P1\nM30\n%\n", "confirmed by no second source", Level.NOTE),
    ],
)
def test_what_the_reader_doubts_reaches_the_commands(tmp_path, lines, says, level):
    job = write_job(tmp_path, more='[control]\nname = "fanuc"\n')
    head = "%\nO1\nT1 M6\nG54 G43 H1 G0 X0. Y0. Z5.\nG1 X1. F100.\n"
    (tmp_path / "part.nc").write_text(head + lines)
    rest = [note for note in prepare(read_job(job)).notes[1:] if note.kind is Kind.CONTROL]
    assert [note.level for note in rest] == ([level] if says else [])
    assert all(says in str(note) for note in rest)
