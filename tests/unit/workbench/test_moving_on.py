"""Work that ends after its user has opened another job, or that opening one would end."""

import asyncio
import json
import shutil

import pytest

from tests.unit.workbench.conftest import Page
from vmach.workbench.command_runs import CommandRun


@pytest.fixture
def bench(measured_folder, tmp_path):
    """Two jobs of one folder, and one of another."""
    for name in ("here", "there"):
        shutil.copytree(measured_folder, tmp_path / name, symlinks=True)
    shutil.copy(tmp_path / "here" / "job.toml", tmp_path / "here" / "second.toml")
    made = Page(tmp_path / "there" / "job.toml")
    made.session.open(tmp_path / "here" / "job.toml")
    with made.client:
        yield made


def test_work_of_another_folder_is_not_ended_unasked(bench, tmp_path):
    run = CommandRun(1, "diagnose", (), state="running")
    bench.session.runs.runs.append(run)
    there = str(tmp_path / "there" / "job.toml")
    asked = bench.post("/api/open", {"job": there})
    assert asked.status_code == 409 and "diagnose is at work" in asked.json()["error"]
    assert bench.get("/api/state").json()["folder"] == str(tmp_path / "here")
    assert bench.post("/api/open", {"job": "second.toml"}).status_code == 200  # the same folder
    opened = bench.post("/api/open", {"job": there, "ends_work": True})
    assert opened.json()["folder"] == str(tmp_path / "there")


@pytest.mark.parametrize("moves_on", [False, True])
def test_a_job_that_is_made_is_opened_where_its_user_still_is(bench, moves_on):
    taken = {}

    def start(kind, words, done=None, *, cut=None):
        taken[kind] = done
        return CommandRun(1, kind, tuple(words))

    bench.session.runs.start = start
    bench.post("/api/add", {"effects": ["backlash:Y"]})
    if moves_on:
        bench.post("/api/open", {"job": "second.toml"})
    shutil.copy(bench.session.folder.root / "job.toml", bench.session.folder.root / "job-2.toml")
    run = CommandRun(1, "add", (), output=json.dumps({"job": "job-2.toml"}))

    async def finish():
        return await taken["add"](run)

    found = asyncio.run(finish())
    assert found["is_opened"] is not moves_on
    assert bench.session.job.name == ("second.toml" if moves_on else "job-2.toml")
    assert ("history" in taken) is not moves_on


def test_a_comparison_is_put_away_with_its_folder(bench, tmp_path):
    bench.post("/api/compare", {"job": "second.toml"})
    assert bench.get("/api/state").json()["other"].endswith("second.toml")
    state = bench.post("/api/open", {"job": str(tmp_path / "there" / "job.toml")}).json()
    assert state["other"] is None
    assert bench.get("/api/other/about").status_code == 400
