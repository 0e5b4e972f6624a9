"""A job that was opened before is seen at once, as long as its files are the same."""

import asyncio
import shutil

import pytest

from tests.unit.workbench.conftest import Page
from vmach.workbench.last_picture import LastPicture
from vmach.workbench.model.remote import ModelRefused, RemoteModel

USUAL = {"quantity": "deviation", "model": "abbe", "changes": []}


class Told:
    """A model that answers what it is told to."""

    def __init__(self, answers):
        self.answers = answers

    async def ask(self, question, **arguments):
        return self.answers[question]


@pytest.fixture
def job(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    (tmp_path / "job.toml").write_text("job")
    (tmp_path / "part.nc").write_text("G0 X0\n")
    return tmp_path / "job.toml"


def answers_about(job, mesh=b"mesh"):
    files = [str(job), str(job.with_name("part.nc"))]
    about = {"tolerance_um": 10.0, "files": files}
    return {"about": (about, b""), "mesh": ({}, mesh), "values": ({"rms_um": 1.5}, b"values")}


def seen(job, answers):
    made = LastPicture(job, [], None)
    for question, answer in answers.items():
        made.note(question, USUAL if question == "values" else {}, answer)


def test_the_next_time_the_answers_are_there(job):
    assert LastPicture(job, [], None).answer("about", {}) is None
    answers = answers_about(job)
    seen(job, answers)
    again = LastPicture(job, [], None)
    assert again.answer("mesh", {}) == answers["mesh"]
    assert again.answer("values", USUAL | {"tolerance_um": 10.0}) == answers["values"]


def test_another_question_is_the_models(job):
    seen(job, answers_about(job))
    again = LastPicture(job, [], None)
    for other in ({"tolerance_um": 5.0}, {"quantity": "residual"}, {"changes": [{}]}):
        assert again.answer("values", USUAL | other) is None
    assert again.answer("effects", {}) is None


@pytest.mark.parametrize("changed", ["job.toml", "part.nc"])
def test_it_does_not_outlive_a_file(job, changed):
    seen(job, answers_about(job))
    job.with_name(changed).write_text("changed")
    assert not LastPicture(job, [], None).is_there


def test_it_is_of_one_control_and_its_effects(job):
    seen(job, answers_about(job))
    assert not LastPicture(job, [], "fanuc").is_there
    assert not LastPicture(job, [job.with_name("part.nc")], None).is_there


@pytest.mark.parametrize("broken", [b"", b"{}\n", b"\xff\xfe", b'{"stamp": 1, "answers": 3}\n'])
def test_a_broken_file_is_no_picture(job, broken):
    seen(job, answers_about(job))
    (kept,) = (job.parent / "state" / "vmach" / "pictures").glob("*.picture")
    kept.write_bytes(broken)
    assert not LastPicture(job, [], None).is_there


def test_the_model_has_the_last_word(job):
    seen(job, answers_about(job))
    again = LastPicture(job, [], None)
    assert asyncio.run(again.holds(Told(answers_about(job))))
    assert again.answer("mesh", {}) is None  # from now on the model answers
    fresh = answers_about(job, mesh=b"other")
    assert not asyncio.run(LastPicture(job, [], None).holds(Told(fresh)))
    assert LastPicture(job, [], None).answer("mesh", {}) == fresh["mesh"]


def test_few_are_kept(job):
    for number in range(15):
        one = job.with_name(f"job-{number}.toml")
        one.write_text("")
        seen(one, answers_about(one))
    assert len(list((job.parent / "state" / "vmach" / "pictures").iterdir())) == 12


def test_the_page_has_its_part_before_the_model_and_is_told_when_that_refuses(
    measured_folder, tmp_path, monkeypatch
):
    shutil.copytree(measured_folder, tmp_path / "part", ignore=shutil.ignore_patterns("vmach-*"))
    ask = "/api/values?tolerance_um=10"
    first = Page(tmp_path / "part" / "job.toml")
    with first.client:
        before = [first.get(address).content for address in ("/api/about", "/api/mesh", ask)]
    may_answer = []

    async def late(self, question, **arguments):
        while not may_answer:
            await asyncio.sleep(0.02)
        raise ModelRefused("the part is gone")

    monkeypatch.setattr(RemoteModel, "ask", late)
    again = Page(tmp_path / "part" / "job.toml")
    with again.client:
        after = [again.get(address).content for address in ("/api/about", "/api/mesh", ask)]
        assert after == before
        revision = again.get("/api/state").json()["revision"]
        may_answer.append(True)
        again.wait_for_revision(revision)
        assert "the part is gone" in again.get("/api/about").text
