"""Undo and redo of everything that is done in the page; no file goes away."""

import json
import re
import shutil

import numpy as np
import pytest

from tests.unit.workbench.conftest import Page
from tests.unit.workbench.test_runs import LAW
from vmach.api.points import predict, surface_points
from vmach.history.set_values import set_values
from vmach.workbench.model.part_model import load_part
from vmach.workbench.steps_back import Step, StepsBack

BACKLASH = {"effect": "backlash", "target": "Y", "parameters": {"reversal_um": 3.0}}
SCALE = {"effect": "scale", "target": "X", "parameters": {"scale_ppm": 20.0}}
#: of a screen that shows the difference of two jobs
VIEW = {"azimuth_rad": 0.4, "elevation_rad": 0.7, "zoom": 1.0, "target_mm": [0.0, 0.0, 0.0],
        "section": [0.0, 0.0, 0.0, 0.0], "range_um": 5.0}  # fmt: skip
SCREEN = {"shown": {"quantity": "deviation", "model": "abbe"}, "tolerance_um": 3, "view": VIEW,
          "is_difference": True}  # fmt: skip


@pytest.fixture(scope="module")
def bench(measured_folder, tmp_path_factory):
    folder = tmp_path_factory.mktemp("steps") / "job"
    shutil.copytree(measured_folder, folder, symlinks=True)
    shutil.copy(folder / "job.toml", folder / "other.toml")
    made = Page(folder / "job.toml")
    with made.client:
        yield made


def move(bench, changes, gesture):
    asked = {"changes": changes, "shown": {}, "tab": "a", "gesture": gesture}
    bench.framed(bench.post("/api/what-if", asked))


def state(bench):
    return bench.get("/api/state").json()


def test_sliders_go_back_a_gesture_at_a_time(bench):
    for size in (1.0, 2.0, 3.0):  # one drag
        move(bench, [BACKLASH | {"parameters": {"reversal_um": size}}], 1)
    move(bench, [BACKLASH, SCALE], 2)
    assert state(bench)["steps"] == {"undo": "scale X", "redo": None}
    assert bench.post("/api/undo").json()["changes"] == [BACKLASH]
    assert bench.post("/api/undo").json()["changes"] == []
    assert state(bench)["steps"] == {"undo": None, "redo": "backlash Y"}
    assert bench.post("/api/undo").status_code == 200  # nothing more to undo
    assert bench.post("/api/redo").json()["changes"] == [BACKLASH]
    move(bench, [SCALE], 3)
    assert state(bench)["steps"]["redo"] is None  # another way was taken


def test_a_job_that_was_opened_goes_back_with_its_sliders(bench):
    move(bench, [BACKLASH], 4)
    bench.post("/api/open", {"job": "other.toml"})
    assert state(bench)["changes"] == [] and state(bench)["steps"]["undo"] == "open other.toml"
    back = bench.post("/api/undo").json()
    assert (back["job"], back["changes"]) == ("job.toml", [BACKLASH])
    assert bench.post("/api/redo").json()["job"] == "other.toml"
    bench.post("/api/undo")


def test_a_job_beside_goes_back(bench):
    beside = str(bench.session.folder.root / "other.toml")
    bench.post("/api/compare", {"job": "other.toml"})
    assert state(bench)["other"] == beside
    assert state(bench)["steps"]["undo"] == "comparison with other"
    assert bench.post("/api/undo").json()["other"] is None


def test_what_the_sliders_say_is_kept_as_a_job_and_goes_back(bench):
    offset = [0.5 * k for k in range(13)]
    changes = [SCALE, {"component": "EXX", "offset": offset, "measured_at_mm": [1.0, 2.0, 3.0]}]
    move(bench, changes, 5)
    _, shown = bench.framed(bench.get("/api/values"))
    bench.post("/api/keep")
    run = bench.wait_for("keep")
    assert run["state"] == "done", run["message"]
    assert run["command"] == ("vmach set job.toml scale:X.scale_ppm=20 EXX=EXX.csv "
                              "EXX.measured_at_mm=1,2,3 --json")  # fmt: skip
    kept = state(bench)
    assert kept["changes"] == [] and kept["job"] == run["result"]["job"]
    _, found = bench.framed(bench.get("/api/values"))
    known = np.isfinite(shown) & np.isfinite(found)
    # to first order; where another move makes a point, it is not the same
    assert np.quantile(np.abs(found - shown)[known], 0.9) < 0.05 < np.abs(shown[known]).max()
    back = bench.post("/api/undo").json()
    assert (back["job"], back["changes"]) == ("job.toml", changes)
    move(bench, [], 6)
    assert bench.post("/api/keep").status_code == 400  # nothing is moved


def test_the_difference_of_two_jobs_has_a_report(bench):
    folder = bench.session.folder.root
    bench.post("/api/open", {"job": "job.toml"})
    beside, _ = set_values(folder / "job.toml", ["scale:X.scale_ppm=40"], out=folder / "wide.toml")
    assert bench.post("/api/report", SCREEN).status_code == 400  # nothing is beside it
    bench.post("/api/compare", {"job": beside.name})
    made = bench.post("/api/report", SCREEN)
    assert made.status_code == 200, made.text
    text = bench.get("/show/" + made.json()["page"]).text
    data = json.loads(re.search(r'id="page-data"[^>]*>(.*?)</script>', text, re.DOTALL)[1])
    column = data["variants"]["shown"]
    assert column["label"] == "Predicted deviation, minus that of wide"
    points = surface_points(*_surface(folder / "job.toml"))
    found = [predict(job, points) for job in (folder / "job.toml", beside)]
    wanted = np.where(found[0].is_cut & found[1].is_cut,
                      found[0].deviation_um - found[1].deviation_um, 0.0)  # fmt: skip
    assert column["largest_um"] == pytest.approx(np.abs(wanted).max(), rel=1e-6)
    assert np.abs(wanted).max() > 0.3
    bench.post("/api/undo")


def _surface(job):
    surface = load_part(job).surface
    return surface.point_mm, surface.normal


def test_what_was_found_goes_back(bench):
    job = bench.session.job
    bench.session.show("diagnosis", {"verdict": "named"}, job, step="diagnosis")
    bench.session.show("diagnosis", {"verdict": "nothing"}, job, step="diagnosis")
    assert state(bench)["steps"]["undo"] == "diagnosis"
    assert bench.post("/api/undo").json()["shown"]["diagnosis"] == {"verdict": "named"}
    assert bench.post("/api/undo").json()["shown"]["diagnosis"] is None
    assert bench.post("/api/redo").json()["shown"]["diagnosis"] == {"verdict": "named"}


def test_the_text_of_an_own_law_goes_back(bench):
    def save(text):
        asked = {"file": "own_law.py", "text": text}
        assert bench.client.put("/api/effect-file", json=asked, headers=bench.headers).is_success

    save("first\n")
    save("second\n")
    file = bench.session.folder.root / "own_law.py"
    bench.post("/api/undo")
    assert file.read_text() == "first\n"
    bench.post("/api/redo")
    assert file.read_text() == "second\n"
    save("third\n")  # what undo wrote is vmach's own, so that it may be written again


def test_a_step_whose_way_is_gone_is_said_once_and_forgotten():
    def gone():
        raise OSError("gone")

    done = []
    steps = StepsBack(lambda: None)
    steps.did(Step("a", lambda: done.append("back"), lambda: None))
    steps.did(Step("b", gone, lambda: None))
    with pytest.raises(OSError, match="gone"):
        steps.undo()
    steps.undo()
    assert done == ["back"] and steps.record() == {"undo": None, "redo": "a"}


def test_a_known_law_that_was_broken_is_checked_and_its_text_taken_back(bench):
    folder = bench.session.folder.root
    good, broken = LAW, LAW.replace("return along", "retrn along")
    put = lambda text: bench.client.put(  # noqa: E731
        "/api/effect-file", json={"file": "lean_y.py", "text": text}, headers=bench.headers
    )
    assert put(good).is_success
    bench.post("/api/check-effect", {"file": "lean_y.py"})
    assert bench.wait_for("check")["state"] == "done"
    assert put(broken).is_success
    bench.session.reload()  # as when the watch has noticed it
    assert bench.get("/api/about").status_code == 400  # the job has a law that cannot be read
    assert bench.post("/api/check-effect", {"file": "lean_y.py"}).status_code == 200
    run = bench.wait_for("check")
    assert run["state"] == "failed" and re.search(r"lean_y\.py:\d+", run["message"])
    assert bench.post("/api/undo").status_code == 200
    assert (folder / "lean_y.py").read_text() == good
    bench.session.reload()
    assert bench.get("/api/about").status_code == 200
    (folder / "lean_y.py").write_text(good + "# mine\n")
    answer = bench.post("/api/redo")
    assert answer.status_code == 400 and "changed outside the page" in answer.json()["error"]
    assert (folder / "lean_y.py").read_text() == good + "# mine\n"
