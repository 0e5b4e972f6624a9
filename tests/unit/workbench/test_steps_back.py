"""Undo and redo of everything that is done in the page; no file goes away."""

import shutil

import pytest

from tests.unit.workbench.conftest import Page
from vmach.workbench.steps_back import Step, StepsBack

BACKLASH = {"effect": "backlash", "target": "Y", "parameters": {"reversal_um": 3.0}}
SCALE = {"effect": "scale", "target": "X", "parameters": {"scale_ppm": 20.0}}


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
