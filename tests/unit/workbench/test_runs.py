"""What commands of the page know: own effects, the control, and files that change meanwhile."""

import json
import shutil
import signal
import time

import pytest

from tests.unit.workbench.conftest import PATIENCE_S, Page, replace

#: what is written for it: a displacement of Y with the place of X
LAW = '''"""Y moves with the place of X."""

from vmach.effects import Effect, along, linear


class LeanY(Effect):
    """A carriage that leans."""

    name = "lean_y"
    title = "Y moves with X"
    parameters = (linear("amount_um", "at the end of the travel", usual=5.0),)
    targets = ("Y",)
    usual_size = "1 to 10 um"
    confirm = "read a straightedge along X"
    cure = "scrape the guide"
    source = "made up for this test"

    def displacement(self, path, target, amount_um):
        return along(target, 1e-3 * amount_um * path.nose_mm[:, 0] / 500.0)
'''


@pytest.fixture
def bench(measured_folder, tmp_path):
    """The measured job with the own effect in it, which the page knows of."""
    folder = tmp_path / "job"
    shutil.copytree(measured_folder, folder, symlinks=True)
    (folder / "lean_y.py").write_text(LAW)
    job = folder / "job.toml"
    shutil.copy(job, folder / "before.toml")
    job.write_text(
        job.read_text()
        + '\n[effects.lean_y.Y]\namount_um = 3.0\n\n[[history]]\nprevious = "before.toml"\n'
        'added = ["lean_y Y"]\neffect_files = {lean_y = "lean_y.py"}\n'
    )
    made = Page(job)
    with made.client:
        yield made


def process_of(bench, run):
    """Its process, when it is there."""
    while bench.session.runs.of_number(run["number"]).process is None:
        bench.get("/api/state")
    return bench.session.runs.of_number(run["number"]).process


def end_of(bench, run):
    """Wait until the process of a run that was stopped has ended."""
    found = bench.session.runs.of_number(run["number"])
    while found.process is not None and found.process.returncode is None:
        bench.get("/api/state")


@pytest.mark.parametrize(
    ("address", "kind"), [("compensate", "compensate"), ("machine", "machine")]
)
def test_every_command_knows_the_own_effect(bench, address, kind):
    answer = bench.post(f"/api/{address}")
    assert answer.status_code == 200, answer.text
    run = bench.wait_for(kind)
    assert run["state"] == "done", run["message"]
    assert run["command"].startswith("vmach --effect-file lean_y.py ")


def test_a_form_is_asked_for_beside_the_own_effect(bench):
    bench.post("/api/propose", {"name": "form_one", "number": 1})
    run = bench.wait_for("propose")
    assert "unknown effect" not in run["message"]


@pytest.mark.parametrize("kind", ["diagnose", "compensate", "machine", "collisions"])
def test_commands_read_the_program_for_the_control_of_the_page(bench, kind):
    bench.session.control = "sinumerik"
    run = bench.post(f"/api/{kind}").json()
    bench.post(f"/api/runs/{run['number']}/stop")
    end_of(bench, run)
    assert run["command"].endswith("--control sinumerik")


def test_a_verdict_of_readings_that_changed_meanwhile_is_not_shown(bench):
    folder = bench.session.folder.root
    points = folder / "points.csv"
    bench.get("/api/about")
    process = process_of(bench, bench.post("/api/diagnose").json())
    process.send_signal(signal.SIGSTOP)  # it cannot end before the file has changed
    rows = points.read_text().splitlines()
    replace(points, "\n".join(rows[:-1]) + "\n")
    process.send_signal(signal.SIGCONT)
    run = bench.wait_for("diagnose")
    assert run["state"] == "failed", run
    assert "points.csv changed while diagnose was at work" in run["message"]
    assert not bench.get("/api/state").json()["shown"].get("diagnosis")
    bench.post("/api/diagnose")  # and again, of the file as it is
    assert bench.wait_for("diagnose")["state"] == "done"
    assert bench.get("/api/state").json()["shown"]["diagnosis"]


@pytest.mark.parametrize("size", [0, -1, 1e9, "0,5", None])
def test_a_size_out_of_bounds_is_refused_in_the_words_of_the_page(bench, size):
    answer = bench.post("/api/compensate", {"resolution_mm": size})
    if size is None:  # the usual one
        assert answer.status_code == 200
        bench.post(f"/api/runs/{answer.json()['number']}/stop")
        end_of(bench, answer.json())
        return
    assert answer.status_code == 400
    assert "resolution of the control, mm" in answer.json()["error"]
    assert "accepted: 1e-06 .. 0.1" in answer.json()["error"]


def test_another_part_is_kept_only_where_it_can_be_evaluated(bench):
    folder = bench.session.folder.root
    text = (folder / "job.toml").read_text()
    (folder / "bare.toml").write_text(text.replace('measured = "points.csv"', ""))
    (folder / "twin.toml").write_text(text)
    bench.post("/api/history", {"other_part": "bare.toml"})
    run = bench.wait_for("history")
    assert run["state"] == "failed" and "no part was measured" in run["message"]
    assert bench.session.other_part is None
    bench.post("/api/history", {"other_part": "twin.toml"})
    run = bench.wait_for("history")
    assert run["state"] == "done", run["message"]
    assert run["result"]["steps"][-1]["check_rms_um"] > 0
    assert bench.get("/api/state").json()["other_part"].endswith("twin.toml")
    assert bench.post("/api/history", {"other_part": "/etc/passwd"}).status_code == 400


def test_a_curve_that_is_kept_is_of_the_other_part_as_it_is(bench):
    folder = bench.session.folder.root
    text = (folder / "job.toml").read_text().replace('"points.csv"', '"twin.csv"')
    (folder / "twin.toml").write_text(text)
    shutil.copy(folder / "points.csv", folder / "twin.csv")
    bench.get("/api/about")  # from then on all files of the job are watched
    bench.session.other_part = folder / "twin.toml"
    bench.session.show("history", {"steps": []})

    def shown_anew():
        again = Page(folder / "job.toml")
        with again.client:
            return again.get("/api/state").json()["shown"]

    assert shown_anew() == {"history": {"steps": []}}
    (folder / "twin.csv").write_text((folder / "twin.csv").read_text() + "\n")
    assert shown_anew() == {}


def twin_of(bench):
    """Another measured part, whose error is shown."""
    folder = bench.session.folder.root
    text = (folder / "job.toml").read_text().replace('"points.csv"', '"twin.csv"')
    (folder / "twin.toml").write_text(text)
    shutil.copy(folder / "points.csv", folder / "twin.csv")
    return folder / "twin.csv"


def fewer(points):
    replace(points, "\n".join(points.read_text().splitlines()[:-9]) + "\n")


def test_an_error_of_another_part_that_changed_meanwhile_is_not_shown(bench):
    points = twin_of(bench)
    bench.get("/api/about")
    process = process_of(bench, bench.post("/api/history", {"other_part": "twin.toml"}).json())
    process.send_signal(signal.SIGSTOP)  # it cannot end before the file has changed
    fewer(points)
    process.send_signal(signal.SIGCONT)
    run = bench.wait_for("history")
    assert run["state"] == "failed", run
    assert "twin.csv changed while history was at work" in run["message"]
    assert not bench.get("/api/state").json()["shown"].get("history")


def test_the_error_on_another_part_follows_its_files(bench):
    points = twin_of(bench)
    bench.post("/api/history", {"other_part": "twin.toml"})
    first = bench.wait_for("history")
    fewer(points)
    end = time.monotonic() + PATIENCE_S
    while (run := bench.wait_for("history"))["number"] == first["number"]:
        assert time.monotonic() < end, "it is not evaluated again"
    assert run["state"] == "done", run["message"]
    errors = [one["result"]["steps"][-1]["check_rms_um"] for one in (first, run)]
    assert errors[0] != errors[1]
    shown = bench.get("/api/state").json()["shown"]["history"]
    assert shown["steps"][-1]["check_rms_um"] == errors[1]
    assert shown["other_part"].endswith("twin.toml")


def test_an_own_effect_that_no_job_has_can_be_dropped(bench):
    folder = bench.session.folder.root
    (folder / "lean_x.py").write_text(LAW.replace("LeanY", "LeanX").replace("lean_y", "lean_x"))
    bench.post("/api/check-effect", {"file": "lean_x.py"})
    assert bench.wait_for("check")["state"] == "done"
    state = bench.get("/api/state").json()
    assert state["loose_effects"] == ["lean_x.py"]
    assert state["own_effects"] == ["lean_y.py", "lean_x.py"]
    refused = bench.post("/api/drop-effect", {"file": "lean_y.py"})
    assert refused.status_code == 400 and "accepted: lean_x.py" in refused.json()["error"]
    dropped = bench.post("/api/drop-effect", {"file": "lean_x.py"}).json()
    assert dropped["own_effects"] == ["lean_y.py"] and dropped["loose_effects"] == []
    assert not [run for run in dropped["runs"] if run["kind"] == "check"]
    assert dropped["steps"]["undo"] == "drop of lean_x.py" and (folder / "lean_x.py").is_file()
    assert bench.post("/api/undo").json()["loose_effects"] == ["lean_x.py"]


def test_what_a_check_said_of_a_text_goes_with_it(bench):
    content = LAW.replace("def displacement", "def displaced")
    bench.put("/api/effect-file", json.dumps({"file": "lean_y.py", "text": content}))
    first = bench.post("/api/check-effect", {"file": "lean_y.py"}).json()
    assert bench.wait_for("check")["state"] == "failed"
    assert not [run for run in bench.post("/api/undo").json()["runs"] if run["kind"] == "check"]
    again = bench.post("/api/check-effect", {"file": "lean_y.py"}).json()
    assert again["number"] > first["number"]  # a number is of one run for ever
    assert bench.wait_for("check")["state"] == "done"


@pytest.mark.parametrize("name", ["a" * 61, "Big", "", 3])
def test_a_name_of_a_proposal_is_refused_with_what_is_accepted(bench, name):
    answer = bench.post("/api/propose", {"name": name, "number": 1})
    assert answer.status_code == 400 and "up to 60 letters" in answer.json()["error"]
