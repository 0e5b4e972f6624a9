"""What was found is shown again by a workbench that is started anew."""

import shutil

import pytest

from tests.unit.workbench.conftest import Page

FOUND = {"verdict": "named", "page": "vmach-results/job/diagnosis.html"}


@pytest.fixture
def folder(measured_folder, tmp_path):
    """A copy of the measured job whose verdict was shown, with a page."""
    made = tmp_path / "part"
    shutil.copytree(measured_folder, made, ignore=shutil.ignore_patterns("vmach-results"))
    (made / "vmach-results" / "job").mkdir(parents=True)
    (made / FOUND["page"]).write_text("page")
    first = Page(made / "job.toml")
    with first.client:
        first.get("/api/about")  # from then on all files of the job are watched
        first.session.show("diagnosis", FOUND, first.session.job, step="diagnosis")
    return made


def shown_anew(folder):
    again = Page(folder / "job.toml")
    with again.client:
        return again.get("/api/state").json()["shown"]


def test_a_verdict_is_shown_again(folder):
    assert shown_anew(folder) == {"diagnosis": FOUND}


@pytest.mark.parametrize("changed", ["job.toml", "part.nc", "points.csv"])
def test_it_does_not_outlive_a_file_of_the_job(folder, changed):
    path = folder / changed
    path.write_text(path.read_text() + "\n")
    assert shown_anew(folder) == {}


def test_it_is_nothing_without_its_page(folder):
    (folder / FOUND["page"]).unlink()
    assert shown_anew(folder) == {}


def test_what_is_undone_stays_away(folder):
    page = Page(folder / "job.toml")
    with page.client:
        page.get("/api/about")
        page.session.show("diagnosis", {"verdict": "nothing"}, page.session.job, step="diagnosis")
        page.post("/api/undo")
    assert shown_anew(folder) == {"diagnosis": FOUND}


@pytest.mark.parametrize("broken", ["", "[]", '{"job.toml": 3}', '{"job.toml": {"diagnosis": 1}}'])
def test_a_broken_file_is_as_none(folder, broken):
    (folder / "vmach-results" / "workbench.json").write_text(broken)
    assert shown_anew(folder) == {}
