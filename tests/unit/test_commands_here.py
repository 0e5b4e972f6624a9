"""Commands without JOB take the job of the folder that they are typed in."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from vmach.cli import app

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
#: what the page lists so, but for those with a meaning of their own where JOB is left out
OF_HERE = sorted(set(re.findall(r"^\| `([a-z ]+) \[JOB\]", PAGE, re.M)) - {"open", "tables"})


@pytest.mark.parametrize("folder_form", [[], ["."]])
def test_the_job_of_this_folder(monkeypatch, folder_form):
    monkeypatch.chdir(ROOT / "samples" / "iso230_4")
    found = CliRunner().invoke(app, ["check", *folder_form, "--json"])
    assert found.exit_code == 0, found.output
    assert json.loads(found.stdout)["ready"]


@pytest.mark.parametrize("command", OF_HERE)
def test_a_folder_without_a_job(tmp_path, monkeypatch, command):
    """Each looks for the file here, whatever else it needs."""
    monkeypatch.chdir(tmp_path)
    needs = {
        "predict": ["--points", "points.csv"],
        "compensate": ["-o", "out.nc"],
        "effects propose": ["-o", "effect.py"],
    }
    found = CliRunner().invoke(app, [*command.split(), *needs.get(command, [])])
    assert found.exit_code == 1
    said = found.output or str(found.exception)
    assert "job.toml" in said and "not found" in said
    assert not list(tmp_path.iterdir())


def test_which_commands_do_so():
    assert len(OF_HERE) >= 9
