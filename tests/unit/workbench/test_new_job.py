"""A job from the form of the start page is the job that was meant."""

import json

import pytest

from tests.small_job import write_job_with_nominal
from tests.unit.workbench.conftest import Page
from vmach.job import read_job
from vmach.workbench.opened_folder import OpenedFolder

MEANT = {
    "name": "bracket",
    "machine": "machine.toml",
    "program": "part.nc",
    "nominal": "part.stl",
    "measured": "points.csv",
    "zero_mm": [-200, -150, -200],
    "min_mm": [-30, -25, -20],
    "max_mm": [60, 25, 0],
    "tools": [{"number": 1, "shape": "flat", "diameter_mm": 10, "length_mm": 100}],
}


@pytest.fixture(scope="module")
def start(tmp_path_factory):
    """The start page of a folder that has files, and no job opened."""
    folder = tmp_path_factory.mktemp("new")
    write_job_with_nominal(folder)
    page = Page(None)
    page.session.open_folder(OpenedFolder(folder))
    with page.client:
        yield page, folder


def test_without_a_job_the_page_offers_what_there_is(start):
    page, folder = start
    assert page.get("/api/state").json()["job"] is None
    offered = page.get("/api/start").json()
    assert str(folder / "job.toml") in offered["jobs"]
    assert {"part.nc", "machine.toml", "points.csv", "part.stl"} <= set(offered["files"])
    assert page.get("/api/values").status_code == 400
    assert page.post("/api/diagnose").status_code == 400


WRONG = [{"name": "../x"}, {"name": "job"}, {"program": "none.nc"}, {"machine": None},
         {"tools": []}, {"zero_mm": [1, 2]}, {"zero_mm": [1, 2, float("1e400")]},
         {"tools": [{"number": 1}]}, {"program": "../part.nc"},
         {"tools": [{"number": "1]\nx", "shape": "flat"}]}]  # fmt: skip


@pytest.mark.parametrize("wrong", WRONG, ids=range(len(WRONG)))
def test_what_is_wrong_is_said_and_nothing_is_written(start, wrong):
    page, folder = start
    before = sorted(folder.iterdir())
    content = json.dumps(MEANT | wrong).encode()
    answer = page.client.post("/api/new-job", content=content, headers=page.headers)
    assert answer.status_code == 400 and answer.json()["error"]
    assert sorted(folder.iterdir()) == before


def test_the_job_is_the_one_that_was_meant(start):
    page, folder = start
    state = page.post("/api/new-job", MEANT).json()
    assert state["job"] == "bracket.toml"
    made, meant = read_job(folder / "bracket.toml"), read_job(folder / "job.toml")
    for name in ("program", "nominal", "measured", "machine_path"):
        assert getattr(made, name) == getattr(meant, name)
    assert made.work_offsets_mm["G54"].tolist() == meant.work_offsets_mm["G54"].tolist()
    assert made.blank.max_mm.tolist() == meant.blank.max_mm.tolist()
    assert made.tools[1].diameter_mm == 10 and made.tools[1].length_mm == 100
    assert page.get("/api/about").json()["name"] == "bracket"


@pytest.mark.parametrize("text", ["G54 G0 X1\nG1 X#\n", "G21\nM30\n"], ids=["broken", "idle"])
def test_a_job_that_does_not_work_is_not_written(start, text):
    page, folder = start
    file = "wrong.nc"
    (folder / file).write_text(text)
    open_before = page.get("/api/state").json()["job"]
    answer = page.post("/api/new-job", MEANT | {"name": "other", "program": file})
    assert answer.status_code == 400 and answer.json()["error"]
    assert not (folder / "other.toml").exists()
    assert page.get("/api/state").json()["job"] == open_before


@pytest.mark.parametrize(("wrong", "said"), [
    ({"name": "Pr\u00fcfling 1"}, "'Prufling-1' would do"),
    ({"tools": [{"number": 1, "shape": "flat", "length_mm": 5}]}, "diameter_mm is missing"),
    ({"zero_mm": None}, "zero_mm is missing"),
], ids=["name", "diameter", "zero"])  # fmt: skip
def test_what_is_wrong_is_said_in_words(start, wrong, said):
    page, _ = start
    error = page.post("/api/new-job", MEANT | wrong).json()["error"]
    assert said in error and "None" not in error
