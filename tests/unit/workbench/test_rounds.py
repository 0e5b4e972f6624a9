"""Adding in rounds: each step is a job with a way back, also where the rounds are stopped."""

import os
import shutil
import signal
import time

import pytest

from tests.unit.workbench.conftest import PATIENCE_S, Page
from tests.unit.workbench.test_runs import LAW, end_of, process_of


@pytest.fixture
def bench(measured_folder, tmp_path):
    folder = tmp_path / "job"
    shutil.copytree(measured_folder, folder, symlinks=True)
    made = Page(folder / "job.toml")
    with made.client:
        yield made


def state(bench):
    return bench.get("/api/state").json()


def test_what_is_shown_is_added_in_rounds_and_taken_back(bench):
    bench.session.control = "linuxcnc"
    folder = bench.session.folder.root
    (folder / "lean_y.py").write_text(LAW)
    bench.session.own_effects.append(folder / "lean_y.py")
    bench.post("/api/add-in-rounds")
    run = bench.wait_for("rounds")
    assert run["state"] == "done", run["message"]
    assert run["command"] == (
        "vmach --effect-file lean_y.py diagnose job.toml --add-all "
        "--out vmach-results/job/rounds --control linuxcnc"
    )
    now = state(bench)
    assert now["job"] == "job-2.toml" and run["result"]["jobs"] == ["job-2.toml"]
    assert [step["added"] for step in now["chain"]] == [[], ["backlash Y"]]
    assert now["steps"]["undo"] == "+ backlash Y"
    left = now["shown"]["diagnosis"]
    assert left["verdict"] == "nothing" and left["job"] == "job-2.toml"
    assert (folder / left["page"]).is_file()
    assert bench.wait_for("history")["state"] == "done"
    back = bench.post("/api/undo").json()
    assert back["job"] == "job.toml" and back["chain"][-1]["is_later"]
    assert bench.post("/api/redo").json()["shown"]["diagnosis"]["verdict"] == "nothing"


def test_every_job_of_the_rounds_is_a_step_back(bench):
    folder, first = bench.session.folder.root, bench.session.job
    jobs = []
    for number, added in ((2, "backlash Y"), (3, "scale X")):
        before = jobs[-1] if jobs else first
        jobs.append(folder / f"job-{number}.toml")
        jobs[-1].write_text(
            first.read_text() + f'\n[[history]]\nprevious = "{before.name}"\nadded = ["{added}"]\n'
        )
    sliders = [{"effect": "backlash", "target": "Y", "parameters": {"reversal_um": 3.0}}]
    bench.session.set_changes(sliders)
    assert bench.session.open_next(*jobs, after=first)
    assert state(bench)["job"] == "job-3.toml" and state(bench)["changes"] == []
    undone = [bench.post("/api/undo").json() for _ in range(2)]
    assert [one["job"] for one in undone] == ["job-2.toml", "job.toml"]
    assert [one["steps"]["redo"] for one in undone] == ["+ scale X", "+ backlash Y"]
    assert undone[-1]["changes"] == sliders
    assert not bench.session.open_next(*jobs, after=jobs[0])  # it is not the open one


def test_rounds_that_are_stopped_leave_the_jobs_that_were_made(bench):
    folder = bench.session.folder.root
    (folder / "old.toml").write_text(  # of an earlier day: not of these rounds
        (folder / "job.toml").read_text() + '\n[[history]]\nprevious = "job.toml"\nadded = ["x"]\n'
    )
    os.utime(folder / "old.toml", (1.0, 1.0))
    run = bench.post("/api/add-in-rounds").json()
    process = process_of(bench, run)
    stage = "fit"
    while stage.endswith("fit") or not stage.startswith("round 1"):  # until its job is written
        assert not bench.session.runs.of_number(run["number"]).is_over
        stage = bench.session.runs.of_number(run["number"]).stage
        bench.get("/api/state")
    process.send_signal(signal.SIGSTOP)  # it cannot end before it is told to
    bench.post(f"/api/runs/{run['number']}/stop")
    process.send_signal(signal.SIGCONT)
    end_of(bench, run)
    end = time.monotonic() + PATIENCE_S
    while not (found := bench.wait_for("rounds"))["result"]:
        assert time.monotonic() < end, found
    assert found["state"] == "stopped" and found["result"]["jobs"] == ["job-2.toml"]
    now = state(bench)
    assert now["job"] == "job.toml" and not now["shown"].get("diagnosis")
    assert [(s["job"], s["is_later"]) for s in now["chain"]][-1] == ("job-2.toml", True)
    assert bench.post("/api/open", {"job": "job-2.toml"}).status_code == 200
    assert bench.get("/api/about").status_code == 200


def test_rounds_stopped_at_once_offer_what_is_written_and_nothing_else(bench):
    """As a rule nothing is; a slow machine may have come further."""
    run = bench.post("/api/add-in-rounds").json()
    bench.post(f"/api/runs/{run['number']}/stop")
    end_of(bench, run)
    written = sorted(path.name for path in bench.session.folder.root.glob("job-*.toml"))
    assert bench.wait_for("rounds")["result"].get("jobs", []) == written
