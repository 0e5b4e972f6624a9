"""The page on imports, followed to the letter: four commands from an empty folder to a report."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

from vmach.cli import app

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "how-to" / "import.md").read_text(encoding="utf-8")
#: what the program of a user says of its tools
TOOLS = "(T1 D=12. - flat end mill)\n(T2 D=10. - flat end mill)\n"


def block(begins):
    """The first block of the page that begins with some words."""
    (found, *_) = [text for text in re.findall(r"```\w*\n(.*?)```", PAGE, re.S)
                   if text.startswith(begins)]  # fmt: skip
    return found


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A STEP, a program and a laser file as its program writes it, in the code page of Windows."""
    sample = ROOT / "samples" / "freecad_pocket"
    shutil.copy(sample / "part.step", tmp_path)
    (tmp_path / "part.nc").write_text(TOOLS + (sample / "part.nc").read_text())
    (tmp_path / "X.csv").write_text(block("Maschine;"), encoding="cp1252")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_page_leads_to_a_first_report(folder):
    commands = block("vmach init").splitlines()
    assert len(commands) <= 4
    said = []
    for command in commands:
        run = CliRunner().invoke(app, shlex.split(command)[1:])
        assert run.exit_code == 0, (command, run.output, run.exception)
        said.append(run.output)
    assert said[1] == block("--squareness:")
    assert "the job can be simulated" in said[2]
    machine = tomllib.loads((folder / "machine.toml").read_text())
    assert machine["squareness"] == {"EC0Y": 34.1}
    assert machine["errors"] == {"EXX": {"table": "errors/EXX.csv"}}
    assert '"errors/EXX.csv"  # mend: nobody has said' in (folder / "machine.toml").read_text()
    (results,) = (folder / "vmach-results").iterdir()
    assert (results / "report.html").is_file()
    summary = json.loads((results / "summary.json").read_text())
    shares = (results / "budget.csv").read_text().splitlines()[0]
    assert "EXX_um" in shares and "EC0Y_um" in shares
    assert summary["variants"]["abbe"]["rms_um"] != summary["variants"]["none"]["rms_um"]


def test_an_angle_after_that_asks_for_the_place_of_the_reflector(folder):
    """Check, import and run agree; a place mends it."""
    for command in block("vmach init").splitlines()[:2]:
        CliRunner().invoke(app, shlex.split(command)[1:])
    rows = ("Position (mm);Pitch (urad)", "-760;0", "-300;8", "0;14")
    (folder / "B.csv").write_text("\n".join(rows).replace("Pitch", "Deviation"))
    told = CliRunner().invoke(app, shlex.split(block("vmach import B.csv"))[1:])
    assert "EXX without measured_at_mm" in told.output
    checked = CliRunner().invoke(app, ["check", ".", "--json"])
    assert checked.exit_code == 1 and "EXX has no measured_at_mm" in checked.output
    assert json.loads(checked.output)["ready"] is False
    run = CliRunner().invoke(app, ["run", ".", "--no-solid"])
    assert "EXX has no measured_at_mm" in str(run.exception)
    machine = folder / "machine.toml"
    place = "[errors.EXX]\nnose_at_mm = [-350, -230, -300]\nstick_out_mm = 120\n"
    machine.write_text(machine.read_text().replace("\n[errors.EXX]\n", "\n" + place))
    assert CliRunner().invoke(app, ["check", "."]).exit_code == 0
    run = CliRunner().invoke(app, ["run", ".", "--no-solid"])
    assert run.exit_code == 0, run.exception
