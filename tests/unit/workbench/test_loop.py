"""Add, go back: the files are those of the commands."""

import asyncio
import shutil
import time

import pytest

from tests.unit.workbench.conftest import PATIENCE_S, Page, replace
from vmach.job import read_job
from vmach.workbench.job_chain import job_chain
from vmach.workbench.model.remote import ModelStopped
from vmach.workbench.session import Session


@pytest.fixture(scope="module")
def bench(measured_folder, tmp_path_factory):
    """A folder of its own, which the loop writes to."""
    folder = tmp_path_factory.mktemp("loop")
    shutil.copytree(measured_folder, folder / "job", symlinks=True)
    made = Page(folder / "job" / "job.toml")
    with made.client:
        yield made


@pytest.fixture(scope="module")
def folder(bench):
    return bench.session.folder.root


def test_an_effect_is_added_and_taken_back(bench, folder):
    bench.post("/api/add", {"effects": ["backlash:Y"]})
    assert bench.wait_for("add")["state"] == "done"
    state = bench.get("/api/state").json()
    assert state["job"] == "job-2.toml"
    assert [step["added"] for step in state["chain"]] == [[], ["backlash Y"]]
    assert read_job(folder / "job-2.toml").effects["backlash"]["Y"]["reversal_um"] > 3
    history = bench.wait_for("history")
    first, second = history["result"]["steps"]
    assert second["held_out_um"] < 0.7 * first["held_out_um"]
    assert bench.get("/api/measured").json()["rms_um"] == pytest.approx(second["rms_um"], rel=1e-6)

    bench.post("/api/open", {"job": "job.toml"})  # undo: the file stays, and is a step forward
    state = bench.get("/api/state").json()
    assert [(s["job"], s["is_later"]) for s in state["chain"]] == [
        ("job.toml", False), ("job-2.toml", True)]  # fmt: skip


def test_what_fails_says_what_the_terminal_says(bench):
    bench.post("/api/add", {"effects": ["backlach:Y"]})
    run = bench.wait_for("add")
    assert run["state"] == "failed" and "unknown effect 'backlach'" in run["message"]
    assert "Traceback" not in run["message"] and not run["message"].startswith("vmach:")


def test_a_run_can_be_stopped_and_leaves_nothing_half_written(bench, folder):
    before = sorted(path.name for path in folder.iterdir())
    run = bench.post("/api/machine").json()
    assert bench.post("/api/machine").status_code == 400  # one of a kind at a time
    while bench.session.runs.of_number(run["number"]).process is None:
        time.sleep(0.01)
    stopped = bench.post(f"/api/runs/{run['number']}/stop").json()
    assert stopped["state"] == "stopped"
    process = bench.session.runs.of_number(run["number"]).process
    end = time.monotonic() + PATIENCE_S
    while process.returncode is None and time.monotonic() < end:
        bench.get("/api/state")
        time.sleep(0.05)
    assert process.returncode is not None
    made = folder / "vmach-results" / "job" / "run"
    # whole where it was written before the word came, or where SIGINT is ignored, as behind nohup
    assert not made.exists() or (made / "summary.json").exists()
    after = {path.name for path in folder.iterdir()}
    assert after - {"vmach-results"} == set(before) - {"vmach-results"}


def test_a_dead_model_is_replaced_and_nothing_is_lost(bench):
    before = bench.get("/api/about").json()
    bench.session.model._process.kill()
    bench.session.model._process.join()
    assert bench.get("/api/about").json() == before
    assert bench.get("/api/values").status_code == 200


def test_a_question_that_kills_every_model_is_given_up(bench):
    class Dead:
        has_answered, asked = True, 0

        async def ask(self, question):
            Dead.asked += 1
            raise ModelStopped("dead")

    async def ask():
        session = Session()
        session._model = Dead()
        session.reload = lambda: setattr(session, "_model", Dead())
        with pytest.raises(ModelStopped):
            await session.ask("about")

    asyncio.run(ask())
    assert Dead.asked == 2  # and once more after it was started again


def test_files_that_change_outside_are_read_again(bench, folder):
    bench.get("/api/about")
    revision = bench.get("/api/state").json()["revision"]
    job = folder / "job.toml"
    good = job.read_text()
    replace(job, good.replace("diameter_mm = 10", 'diameter_mm = "ten"'))
    revision = bench.wait_for_revision(revision)
    answer = bench.get("/api/about")
    assert answer.status_code == 400 and "diameter_mm" in answer.json()["error"]
    replace(job, good)
    bench.wait_for_revision(revision)
    assert bench.get("/api/about").status_code == 200


def test_an_own_law_is_checked_in_the_words_of_the_checker(bench, folder):
    wrong = "from vmach.effects import Effect\nclass A(Effect):\n    name = 'a_b'\n"
    for text in ("x = 1\n", wrong):  # saved again before any check went well
        answer = bench.client.put(
            "/api/effect-file", json={"file": "a_b.py", "text": text}, headers=bench.headers
        )
        assert answer.status_code == 200, answer.text
    assert (folder / "a_b.py").read_text() == wrong
    other = {"file": "of_the_user.py", "text": wrong}
    (folder / "of_the_user.py").write_text("mine")
    refused = bench.client.put("/api/effect-file", json=other, headers=bench.headers)
    assert refused.status_code == 400 and (folder / "of_the_user.py").read_text() == "mine"
    bench.post("/api/check-effect", {"file": "a_b.py"})
    run = bench.wait_for("check")
    assert run["state"] == "failed" and "a_b.py" in run["message"] and "title" in run["message"]


def test_readings_that_come_later_are_in_a_new_job(bench, folder):
    bench.post("/api/open", {"job": "job.toml"})
    text = (folder / "points.csv").read_text()
    taken = bench.put("/api/files/again.csv", text.encode()).json()["file"]
    wrong = bench.post("/api/readings", {"file": taken, "settings": {"kind": "ballbar"}})
    assert wrong.status_code == 400 and "tool_length_mm" in wrong.json()["error"]
    before = (folder / "job.toml").read_bytes()
    state = bench.post("/api/readings", {"file": taken, "settings": {"kind": "part"}}).json()
    assert state["chain"][-1]["added"] == ["readings again.csv in place of points.csv"]
    assert read_job(folder / state["job"]).measured.name == "again.csv"
    assert bench.get("/api/measured").json()["measurements"][0]["name"] == "again.csv"
    assert (folder / "job.toml").read_bytes() == before
    assert {f["kind"] for f in bench.get("/api/instruments").json()["forms"]} >= {"part", "laser"}


def test_a_chain_that_goes_round_ends(tmp_path):
    for name, previous in (("a", "b"), ("b", "a")):
        (tmp_path / f"{name}.toml").write_text(
            f'[[history]]\nprevious = "{previous}.toml"\nadded = ["x"]\n'
        )
    assert len(job_chain(tmp_path / "a.toml")) <= 3


def test_the_page_can_end_it(bench):
    bench.post("/api/shut-down")
    assert bench.closed == [True]
