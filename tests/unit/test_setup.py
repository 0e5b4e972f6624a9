"""``vmach init``: from a program and a CAD file to a job that can be checked and run."""

import shutil
import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from vmach.checkup import Weight, check_job
from vmach.cli import app
from vmach.machine.chain import Chain
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
