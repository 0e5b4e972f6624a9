"""What users get wrong: one message with file, line, value and what is accepted; exit status 1."""

import io
import sys

import pytest

from tests.small_job import write_job, write_nominal_stl
from vmach import cli
from vmach.__main__ import main
from vmach.errors import InputError
from vmach.job import read_job


@pytest.fixture
def job(tmp_path):
    folder = tmp_path / "job"
    folder.mkdir()
    return write_job(folder)


def run_vmach(monkeypatch, capsys, *arguments):
    """Exit status, standard output and standard error of a command."""
    monkeypatch.setattr(sys, "argv", ["vmach", *map(str, arguments)])
    with pytest.raises(SystemExit) as stopped:
        cli.main()
        raise SystemExit(0)
    captured = capsys.readouterr()
    return stopped.value.code, captured.out, captured.err


def replace(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


CASES = {
    "missing machine file": (
        lambda f: (f / "machine.toml").unlink(),
        ["job.toml:2", "machine.toml", "no such file"],
    ),
    "missing program": (
        lambda f: (f / "part.nc").unlink(),
        ["job.toml:3", "part.nc", "no such file"],
    ),
    "missing error table": (
        lambda f: replace(
            f / "machine.toml", "[axes.X]", '[errors.EXX]\ntable = "no.csv"\n[axes.X]'
        ),
        ["machine.toml:12", "no.csv", "no such file"],
    ),
    "unknown key": (
        lambda f: replace(f / "job.toml", "diameter_mm", "diametre_mm"),
        ["job.toml:", "tools.1.diametre_mm", "accepted: ", "did you mean 'diameter_mm'?"],
    ),
    "wrong type": (
        lambda f: replace(f / "job.toml", "length_mm = 100", 'length_mm = "long"'),
        ["job.toml:", "tools.1.length_mm", "'long'"],
    ),
    "number in quotes": (
        lambda f: replace(f / "job.toml", "length_mm = 100", 'length_mm = "100"'),
        ["job.toml:", "tools.1.length_mm", "accepted: a number"],
    ),
    "decimal comma": (
        lambda f: replace(f / "job.toml", "diameter_mm = 10", "diameter_mm = 10,5"),
        ["job.toml:12", "'diameter_mm = 10,5'", "decimal point"],
    ),
    "job in another encoding": (
        lambda f: (f / "job.toml").write_bytes("schema = 1\n# Fräser".encode("latin-1")),
        ["job.toml:2", "0xe4", "accepted: UTF-8"],
    ),
    "table with semicolons": (
        lambda f: (
            (f / "EXX.csv").write_text("position_mm;forward;backward\n0;1,5;2\n"),
            replace(f / "machine.toml", "[axes.X]", '[errors.EXX]\ntable = "EXX.csv"\n[axes.X]'),
        ),
        ["EXX.csv:1", "position_mm;forward;backward", "separate the columns by commas"],
    ),
    "table in another unit": (
        lambda f: (
            (f / "EXX.csv").write_text("position_mm,forward,backward\n-400,1,1e6\n0,1,1\n"),
            replace(f / "machine.toml", "[axes.X]", '[errors.EXX]\ntable = "EXX.csv"\n[axes.X]'),
        ),
        ["EXX.csv:2", "an error of 1000 mm", "accepted: 1 mm at most", "unit"],
    ),
    "effect's parameter in quotes": (
        lambda f: (f / "job.toml").write_text(
            (f / "job.toml").read_text() + '[effects.backlash.X]\nreversal_um = "6"\n'
        ),
        ["job.toml:15", "reversal_um = '6' is no number", "accepted: -10000 .. 10000"],
    ),
    "datum that the part lacks": (
        lambda f: (f / "job.toml").write_text(
            (f / "job.toml").read_text() + '[inspection]\nalignment = "datum"\ndatums = [["lid"]]\n'
        ),
        ["job.toml: no point lies on the datum feature 'lid'", "accepted: 'bore', 'floor'"],
    ),
    "holder without a volume": (
        lambda f: replace(
            f / "job.toml", "diameter_mm = 10", "diameter_mm = 10\nholder_mm = [[0, 100]]"
        ),
        ["job.toml:", "tool 1: holder_mm = [[0.0, 100.0]]", "accepted: two or more pairs"],
    ),
    "folder for a file": (
        lambda f: ((f / "part.nc").unlink(), (f / "part.nc").mkdir()),
        ["job.toml:3", "part.nc", "is a folder"],
    ),
    "tool as large as a hall": (
        lambda f: replace(f / "job.toml", "diameter_mm = 10", "diameter_mm = 1e300"),
        ["job.toml:", "tools.1.diameter_mm", "accepted: less than"],
    ),
    "tool of zero diameter": (
        lambda f: replace(f / "job.toml", "diameter_mm = 10", "diameter_mm = 0"),
        ["job.toml:", "tools.1.diameter_mm", "greater than 0"],
    ),
    "tool of no diameter to speak of": (
        lambda f: replace(f / "job.toml", "diameter_mm = 10", "diameter_mm = 1e-300"),
        ["job.toml:", "tools.1.diameter_mm", "accepted: 1e-09 or more"],
    ),
    "spacing of points that divides by zero": (
        lambda f: replace(
            f / "job.toml", "[tools.1]", "[inspection]\nspacing_mm = 1e-300\n[tools.1]"
        ),
        ["job.toml:", "'inspection.spacing_mm' = 1e-300", "accepted: 1e-09 or more"],
    ),
    "corner radius larger than the tool": (
        lambda f: replace(f / "job.toml", 'shape = "flat"', 'shape = "bull"\ncorner_radius_mm = 6'),
        ["job.toml:", "tool 1", "corner_radius_mm = 6", "accepted"],
    ),
    "tool that the job lacks": (
        lambda f: replace(f / "part.nc", "T1 M6", "T7 M6"),
        ["part.nc:3", "T7", "accepted: tools 1", "(hint: add a table [tools.7] with shape, diam"],
    ),
    "tool that the job lacks, in a program with a number": (
        lambda f: replace(f / "part.nc", "G21 G17 G90 G94 G40\nT1 M6", "O1\nG21 G90\nT7 M6"),
        ["part.nc:4", "T7", "(hint: add a table [tools.7] with", "length_mm to job.toml)"],
    ),
    "move outside the travel": (
        lambda f: replace(f / "part.nc", "X40 Y0", "X340 Y0"),
        ["part.nc:19", "X goes to 140.000 mm", "accepted: -400 .. 0 mm"],
    ),
    "arc whose radii disagree": (
        lambda f: replace(f / "part.nc", "G2 X41 Y0 I-1", "G2 X45 Y0 I-1"),
        ["part.nc:22", "radius"],
    ),
    "program without motion": (
        lambda f: (f / "part.nc").write_text("%\nG21 G90\nM30\n%\n"),
        ["part.nc", "moves no tool"],
    ),
    "not a word of G-code": (
        lambda f: replace(f / "part.nc", "X-15\n", "X-15 ?\n"),
        ["part.nc:11:5", "'?'"],
    ),
    "nothing to inspect": (
        lambda f: replace(f / "job.toml", 'measured = "points.csv"\n', ""),
        ["job.toml", "nothing to inspect", "nominal", "measured"],
    ),
    "stock upside down": (
        lambda f: replace(f / "job.toml", "max_mm = [60, 25, 0]", "max_mm = [60, 25, -30]"),
        ["job.toml:", "max_mm", "accepted"],
    ),
    "rotary motion": (
        lambda f: replace(f / "part.nc", "G0 X40 Y0", "G0 X40 Y0 A30"),
        ["part.nc:19", "A turns to 30 degrees", "three-axis"],
    ),
    "no stock": (
        lambda f: replace(
            f / "job.toml",
            "[stock]\nmin_mm = [-30, -25, -20]\nmax_mm = [60, 25, 0]\n",
            "",
        ),
        ["job.toml", "needs a blank", "[stock]"],
    ),
    "work offset that the job lacks": (
        lambda f: replace(f / "part.nc", "G54", "G55"),
        ["part.nc:", "G55", "G54"],
    ),
    "normal that is no unit vector": (
        lambda f: replace(f / "points.csv", ",-1.0,0.0,0.0,", ",-3.0,0.0,0.0,"),
        ["points.csv:2", "length 3"],
    ),
    "chain without a bed": (
        lambda f: replace(f / "machine.toml", "Z Y b X'", "Z Y X'"),
        ["machine.toml:3", "accepted"],
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_one_clear_message_and_nothing_written(name, job, tmp_path, monkeypatch, capsys):
    spoil, expected = CASES[name]
    spoil(job.parent)
    out = tmp_path / "out"
    status, _, message = run_vmach(monkeypatch, capsys, "run", job, "--out", out)
    assert status == 1
    assert message.startswith("vmach: ")
    assert message.count("\n") == 1
    for words in expected:
        assert words in message
    assert not out.exists()
    assert [p.name for p in tmp_path.iterdir()] == ["job"]


def test_nominal_far_from_the_stock(job, tmp_path, monkeypatch, capsys):
    write_nominal_stl(job.parent / "part.stl", shift_mm=(500, 0, 0))
    replace(job, "measured =", 'nominal = "part.stl"\nmeasured =')
    status, _, message = run_vmach(monkeypatch, capsys, "run", job, "--out", tmp_path / "out")
    assert status == 1
    assert "part.stl: the nominal part spans 470..560" in message
    assert "accepted: inside -30..60" in message


def test_open_mesh(job, tmp_path, monkeypatch, capsys):
    path = job.parent / "part.stl"
    write_nominal_stl(path)
    data = bytearray(path.read_bytes())
    count = int.from_bytes(data[80:84], "little") - 1
    path.write_bytes(bytes(data[:80]) + count.to_bytes(4, "little") + bytes(data[84:-50]))
    replace(job, "measured =", 'nominal = "part.stl"\nmeasured =')
    status, _, message = run_vmach(monkeypatch, capsys, "run", job, "--out", tmp_path / "out")
    assert status == 1
    assert "part.stl: the mesh is open" in message


def test_output_folder_that_is_a_file(job, tmp_path, monkeypatch, capsys):
    (tmp_path / "out").write_text("precious")
    status, _, message = run_vmach(monkeypatch, capsys, "run", job, "--out", tmp_path / "out")
    assert status == 1
    assert "out" in message
    assert (tmp_path / "out").read_text() == "precious"


def test_wrong_usage(monkeypatch, capsys):
    assert run_vmach(monkeypatch, capsys, "add")[0] == 2
    assert run_vmach(monkeypatch, capsys, "run", "x", "--model", "none-such")[0] == 2
    assert run_vmach(monkeypatch, capsys, "frobnicate")[0] == 2


@pytest.mark.parametrize(
    "arguments",
    [
        ["predict", "--points", "points.csv", "-o", "points.csv"],
        ["predict", "--points", "points.csv", "-o", "job.toml"],
        ["path", "-o", "part.nc"],
        ["run", "--part", "part.stl", "--out", "."],
        ["run", "--out", "."],
        ["compensate", "-o", "part.nc"],
        ["diagnose", "--json", "machine.toml"],
        ["history", "--picture", "points.csv"],
    ],
)
def test_no_result_replaces_a_file_that_is_read(arguments, job, monkeypatch, capsys):
    write_nominal_stl(job.parent / "part.stl")
    replace(job, "measured =", 'nominal = "part.stl"\nmeasured =')
    monkeypatch.chdir(job.parent)
    before = {path: path.read_bytes() for path in job.parent.iterdir()}
    command, *rest = arguments
    status, _, message = run_vmach(monkeypatch, capsys, command, job.name, *rest)
    assert status == 1
    assert "is read by this command" in message
    assert {path: path.read_bytes() for path in job.parent.iterdir()} == before


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (
            ["predict", "--points", "points.csv", "-o", "t.xlsx"],
            "'.xlsx' for a table; accepted: .csv",
        ),
        (["path", "-o", "t.txt"], "'.txt' for a table; accepted: .csv, .npz, .parquet"),
        (["history", "--picture", "t.jpg"], "'.jpg' for the picture; accepted: .png"),
        (["run", "--part", "t.foo"], "'.foo' for the coloured part; accepted: .stl, .3mf, .glb"),
        (["run", "--part", "t"], "a name without an ending for the coloured part; accepted: "),
        (["compensate", "-o", "t.nc", "--report", "t.pdf"], "'.pdf' for a report; accepted: .html"),
        (["set", "backlash:X.reversal_um=3", "-o", "t.csv"], "'.csv' for a job; accepted: .toml"),
        (["add", "backlash:X", "-o", "t.csv"], "'.csv' for a job; accepted: .toml"),
    ],
)
def test_an_ending_of_another_kind_is_refused_before_the_work(
    arguments, said, job, monkeypatch, capsys
):
    monkeypatch.chdir(job.parent)
    before = sorted(job.parent.iterdir())
    job.with_name("part.nc").unlink()  # the work could not begin
    job.with_name("part.nc").write_text("%\nnonsense\n")
    command, *rest = arguments
    status, _, message = run_vmach(monkeypatch, capsys, command, job.name, *rest)
    assert status == 1
    assert "vmach: t" in message and said in message
    assert sorted(job.parent.iterdir()) == before


@pytest.mark.parametrize("command", ["canon", "predict", "init"])
def test_a_folder_is_no_program(command, job, monkeypatch, capsys):
    monkeypatch.chdir(job.parent)
    job.with_name("programs").mkdir()
    words = {
        "canon": ["programs"],
        "predict": [job.name, "--points", "points.csv", "--program", "programs"],
        "init": ["--program", "programs", "--yes"],
    }[command]
    status, _, message = run_vmach(monkeypatch, capsys, command, *words)
    assert (status, message) == (
        1, "vmach: programs: NC program is a folder, not a file; accepted: a file\n",
    )  # fmt: skip


@pytest.mark.parametrize("raised", [KeyboardInterrupt, SystemExit(130)])
def test_an_interrupt_ends_with_one_line(raised, monkeypatch, capsys):
    def interrupted():
        raise raised

    monkeypatch.setattr(cli, "main", interrupted)
    with pytest.raises(SystemExit) as stopped:
        main()
    assert stopped.value.code == 130
    assert capsys.readouterr().err == "vmach: interrupted; no file is half-written\n"


def test_a_fault_of_the_program_is_told_as_one(monkeypatch, capsys):
    def faulty():
        raise IndexError("list index out of range")

    monkeypatch.setattr(cli, "main", faulty)
    with pytest.raises(SystemExit) as stopped:
        main()
    assert stopped.value.code == 70
    told = capsys.readouterr().err
    assert told.startswith("vmach: a fault of the program itself: IndexError: list index")
    assert told.count("\n") == 1
    monkeypatch.setenv("VMACH_TRACEBACK", "1")
    with pytest.raises(IndexError):
        main()


def test_a_terminal_that_lacks_a_sign_shows_another(monkeypatch):
    poor = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    monkeypatch.setattr(sys, "stdout", poor)
    monkeypatch.setattr(sys, "argv", ["vmach", "--version"])
    with pytest.raises(SystemExit):
        main()
    print("\N{PLUS-MINUS SIGN}10 um", flush=True)
    assert sys.stdout.buffer.getvalue().endswith(b"?10 um\n")


@pytest.mark.parametrize(
    ("name", "expected"),
    [("simens", "accepted: centroid, fanuc, "),
     ("siemens", "part.nc: a linuxcnc program cannot be written for sinumerik")],
)  # fmt: skip
def test_wrong_control_is_refused_before_anything_is_solved(
    name, expected, job, tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr("vmach.compensation.aim.surface.read_surface", None)  # what comes first
    arguments = ("compensate", job, "-o", tmp_path / "out.nc", "--dialect", name)
    status, _, message = run_vmach(monkeypatch, capsys, *arguments)
    assert status == 1
    assert expected in message


def test_a_job_has_the_same_names_of_dialects(job, monkeypatch, capsys):
    replace(job, "measured", 'dialect = "siemens"\nmeasured')
    assert read_job(job).dialect == "sinumerik"
    replace(job, "siemens", "simens")
    status, _, message = run_vmach(monkeypatch, capsys, "predict", job, "--points", job)
    assert status == 1
    assert "accepted: auto, centroid, fanuc, " in message


@pytest.mark.parametrize("text", ["%\nO1\n", "G21 G90\n", "(part)\nG0 X1\n", "0 BEGIN PGM A MM\n"])
def test_a_program_in_place_of_the_job_is_told(tmp_path, text):
    program = tmp_path / "part.nc"
    program.write_text(text)
    with pytest.raises(InputError, match=r"NC program.*accepted: a job file.*'vmach init' writes"):
        read_job(program)
    (tmp_path / "job.toml").write_text("")
    with pytest.raises(InputError, match=r"is it .*job\.toml\?"):
        read_job(program)
