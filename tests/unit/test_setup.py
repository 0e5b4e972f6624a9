"""``vmach init``: from a program and a CAD file to a job that can be checked and run."""

import os
import re
import shutil
import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from vmach.checkup import Weight, check_job
from vmach.cli import app
from vmach.errors import InputError
from vmach.history.set_values import set_values
from vmach.job import read_job
from vmach.machine.chain import Chain
from vmach.machine.tables.error_table import MM_PER, read_error_table
from vmach.setup import KINEMATICS
from vmach.setup.said_tools import said_tools

SAMPLE = Path(__file__).parents[2] / "samples" / "freecad_pocket"


@pytest.fixture
def folder(tmp_path):
    for name in ("part.nc", "part.step"):
        shutil.copy(SAMPLE / name, tmp_path)
    return tmp_path


def init(*arguments):
    return CliRunner().invoke(app, ["init", *map(str, arguments)])


def test_a_new_job_has_nothing_to_mend_and_what_the_program_asks_for(folder):
    run = init(folder, "--yes", "--travel", "800 500 500", "--kinematics", "bridge")
    assert run.exit_code == 0, run.output
    job = tomllib.loads((folder / "job.toml").read_text())
    assert set(job["tools"]) == {"1", "2"}
    assert set(job["work_offsets_mm"]) == {"G54"}
    assert job["nominal"] == "part.step"
    sample = tomllib.loads((SAMPLE / "job.toml").read_text())["stock"]
    assert all(a <= b for a, b in zip(job["stock"]["min_mm"], sample["min_mm"], strict=True))
    assert all(a >= b for a, b in zip(job["stock"]["max_mm"], sample["max_mm"], strict=True))
    machine = tomllib.loads((folder / "machine.toml").read_text())
    assert machine["chain"] == KINEMATICS["bridge"].chain
    assert machine["axes"]["X"]["travel_mm"] == [-800, 0]
    assert not [f for f in check_job(folder) if f.weight is Weight.MEND]


def test_headers_of_tables_that_the_machine_file_names_are_read(folder):
    init(folder, "--yes")
    text = (folder / "machine.toml").read_text()
    headers = re.findall(r"position_mm[\w,]*,\w+", text)
    assert len(headers) == 2
    for header in headers:
        row = ",0" * header.count(",")
        (folder / "EXX.csv").write_text(f"{header}\n0{row}\n10{row}\n")
        assert len(read_error_table(folder / "EXX.csv", MM_PER, "um").position) == 2


def test_check_lists_every_guess_until_it_is_mended(folder):
    init(folder, "--yes")
    text = (folder / "job.toml").read_text()
    guessed = [k for k, line in enumerate(text.splitlines(), 1) if "# mend" in line]
    found = [f.line for f in check_job(folder) if "a guess of vmach" in f.what
             and f.file == folder / "job.toml"]  # fmt: skip
    assert sorted(found) == guessed and guessed
    (folder / "job.toml").write_text(text.replace("# mend", "#"))
    assert not [f for f in check_job(folder) if "guess" in f.what and f.file.name == "job.toml"]


def test_nothing_is_written_over_a_file_that_is_there(folder):
    (folder / "machine.toml").write_text("mine")
    run = init(folder, "--yes")
    assert run.exit_code != 0
    assert "there already" in str(run.exception)
    assert (folder / "machine.toml").read_text() == "mine"
    assert not (folder / "job.toml").exists()


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["--travel", "1 2"], "three lengths"),
        (["--travel", "a b c"], "three lengths"),
        (["--travel", "0 1 1"], "three lengths"),
        (["--kinematics", "lathe"], "vmc, bridge"),
        (["--program", "nowhere.nc"], "not found"),
    ],
)
def test_bad_answers_are_refused(folder, arguments, word):
    run = init(folder, "--yes", *arguments)
    assert word in str(run.exception)
    assert not (folder / "job.toml").exists()


def test_files_are_found_whatever_the_case_of_their_endings(folder):
    (folder / "part.nc").rename(folder / "PART.NC")
    (folder / "part.step").rename(folder / "Part.Step")
    assert init(folder, "--yes").exit_code == 0
    job = tomllib.loads((folder / "job.toml").read_text())
    assert (job["program"], job["nominal"]) == ("PART.NC", "Part.Step")


def test_several_programs_have_to_be_named(folder):
    shutil.copy(folder / "part.nc", folder / "other.nc")
    assert "--program FILE" in str(init(folder, "--yes").exception)
    assert init(folder, "--yes", "--program", folder / "other.nc").exit_code == 0


@pytest.mark.parametrize("kind", KINEMATICS.values(), ids=lambda kind: kind.name)
def test_every_chain_is_one_that_a_machine_file_may_have(kind):
    assert Chain.parse(kind.chain)


def test_tools_of_comments():
    text = (
        "(T1 D=6. CR=0. - ZMIN=-4. - flat end mill)\n(T2 D=8 CR=4 - ball end mill)\n"
        "; T3 D=10 CR=1 - bull nose\n3  ;  #5 D=6.8 TAPER=118deg - ZMIN=-33 - drill\n"
        "(D=9)\n(T7 D=.)\n"
    )
    found = said_tools(text)
    assert {k: (t.shape, t.diameter) for k, t in found.items()} == {
        1: ("flat", 6.0), 2: ("ball", 8.0), 3: ("bull", 10.0), 5: ("drill", 6.8),
    }  # fmt: skip


def test_tools_of_comments_as_people_write_them():
    text = (
        "(T1 FACE MILL D50 L=120)\n(T2 10MM END MILL)\n(T3 DRILL DIA 8,5)\n"
        "N40 T4 M06 (BALL MILL Ø6)\nT05 M6 ; D12 end mill R1.5\n(T6 SCHAFTFRÄSER D16)\n"
        "(T7 SPIRALBOHRER D5)\n(T8 D8 H8 END MILL)\n(T9 PROBE D6)\n(10 END MILL D4)\n"
        "(T1 END MILL D3)\nG41 D2 (END MILL 5 MM DEEP)\n"
    )
    found = said_tools(text)
    assert {k: (t.shape, t.diameter, t.corner_radius) for k, t in found.items()} == {
        1: ("flat", 50.0, 0.0), 2: ("flat", 10.0, 0.0), 3: ("drill", 8.5, 0.0),
        4: ("ball", 6.0, 3.0), 5: ("bull", 12.0, 1.5), 6: ("flat", 16.0, 0.0),
        7: ("drill", 5.0, 0.0),
    }  # fmt: skip  # 8 names offsets, 9 is no cutter, 10 is no tool's name
    assert [number for number, tool in found.items() if tool.is_mm] == [2]


@pytest.mark.parametrize("name", ['6" plate', "back\\slash", "two\nlines", "del\x7f", "Würfel 😀"])
def test_any_name_of_a_file_is_written_so_that_it_is_read(folder, name):
    program, nominal = folder / f"{name}.nc", folder / f"{name}.step"
    (folder / "part.nc").rename(program)
    (folder / "part.step").rename(nominal)
    assert init(folder, "--yes").exit_code == 0
    job = tomllib.loads((folder / "job.toml").read_text(encoding="utf-8"))
    assert (job["program"], job["nominal"]) == (program.name, nominal.name)
    made, _ = set_values(folder / "job.toml", ["backlash:X.reversal_um=1"])
    again, _ = set_values(made.rename(folder / f"{name}.toml"), ["backlash:X.reversal_um=2"])
    assert read_job(again).history[-1]["previous"] == f"{name}.toml"


def test_a_name_that_is_not_utf_8_is_refused_and_nothing_is_written(folder):
    (folder / "part.nc").rename(folder / os.fsdecode(b"caf\xe9.nc"))
    error = init(folder, "--yes").exception
    assert isinstance(error, InputError) and "not UTF-8" in str(error)
    assert not (folder / "job.toml").exists() and not (folder / "machine.toml").exists()


@pytest.mark.parametrize("text", ["", "(nothing but words)\n", "%\n", "G0 X1\nM30\n"])
def test_a_program_that_cuts_nothing_is_refused(tmp_path, text):
    (tmp_path / "part.nc").write_text(text)
    error = init(tmp_path, "--yes").exception
    assert isinstance(error, InputError)
    assert str(error).startswith(f"{tmp_path / 'part.nc'}: the program cuts nothing")
    assert not (tmp_path / "job.toml").exists()
