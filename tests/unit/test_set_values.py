"""`vmach set`: a job with other values, and what stays of the old one."""

import tomllib

import numpy as np
import pytest

from tests.small_job import write_job
from vmach.api.points import predict
from vmach.errors import InputError
from vmach.history import set_values as set_values_module
from vmach.history.set_values import set_values
from vmach.job import read_job

ERRORS = {
    "EXX": (lambda x: 8e-3 * (x + 200.0), (0.0, -150.0, -200.0)),
    "ECX": (lambda x: 0.02 * x, None),
}
#: as two rounds of `vmach add` leave it: tables of one name are apart
TWICE_ADDED = """
[effects.backlash.Y]  # worn
reversal_um = 4

[[fitted]]
effect = "backlash"
target = "Y"
one_sigma = [
    {reversal_um = 0.2},
]

[[history]]
previous = "first.toml"
added = ["backlash Y"]

[effects.scale.X]
scale_ppm = 10

[[fitted]]
effect = "scale"
target = "X"
one_sigma = [
    {scale_ppm = 1.0},
]

[[history]]
previous = "second.toml"
added = ["scale X"]
effect_files = {own = "own.py"}
"""


@pytest.fixture
def job(tmp_path):
    made = write_job(tmp_path, ERRORS)
    made.write_text(made.read_text() + TWICE_ADDED)
    return made


def test_an_effect_has_the_new_value_and_all_else_stays(job):
    before = tomllib.loads(job.read_text())
    made, machine = set_values(job, ["backlash:Y.reversal_um=6.5", "backlash:X.reversal_um=1"])
    after = tomllib.loads(made.read_text())
    assert machine is None and made.name == "job-2.toml"
    before["effects"]["backlash"] = {"Y": {"reversal_um": 6.5}, "X": {"reversal_um": 1.0}}
    before["fitted"] = before["fitted"][1:]  # what was open of the old size is not of the new one
    before["history"].append({
        "previous": "job.toml", "effect_files": {"own": "own.py"},
        "added": ["backlash Y reversal_um 6.5", "backlash X reversal_um 1"],
    })  # fmt: skip
    assert after == before
    assert "# worn" in made.read_text()


def test_the_prediction_is_that_of_the_job_written_by_hand(job):
    made, _ = set_values(job, ["backlash:Y.reversal_um=6.5"])
    by_hand = job.with_name("hand.toml")
    by_hand.write_text(job.read_text().replace("reversal_um = 4", "reversal_um = 6.5"))
    points = job.with_name("points.csv")
    found, wanted = (predict(path, points).deviation_um for path in (made, by_hand))
    np.testing.assert_array_equal(found, wanted)


def test_a_table_and_a_place_are_in_a_machine_file_of_their_own(job):
    table = job.with_name("drawn.csv")
    table.write_text("position_mm,forward_um,backward_um\n-400,0,1\n-100,9,9\n0,3,3\n")
    words = [f"EXX={table}", "EXX.measured_at_mm=1,-2,3", f"EYY={table}"]
    made, machine = set_values(job, words)
    old, new = read_job(job).machine, read_job(made).machine
    assert machine == job.with_name("machine-2.toml")
    assert new.components["EXX"].evaluate(np.array([-250.0]), np.ones(1)) == pytest.approx(4.5e-3)
    assert new.components["EXX"].measured_at_mm.tolist() == [1, -2, 3]
    assert new.components["EYY"].measured_at_mm.tolist() == [0, 0, 0]
    where = np.array([-333.0, -20.0])
    np.testing.assert_array_equal(
        *(m.components["ECX"].evaluate(where, np.ones(2)) for m in (old, new))
    )


VOLUMETRIC = """[volumetric]
file = "vc.csv"
format = "isg-csv"
measured_at_mm = [7, 8, 9]
"""


def of_volumetric_machine(job):
    """The same job with all errors of its machine in one volumetric file, in mm and rad."""
    machine = job.with_name("machine.toml")
    text = machine.read_text()
    errors = text[text.index("[errors") :]
    machine.write_text(text.replace(errors, VOLUMETRIC))
    job.with_name("vc.csv").write_text("X EXX ECX\n-500 0.001 2e-6\n0 0.003 4e-6\n")
    return job


@pytest.mark.parametrize("elsewhere", [False, True])
def test_a_table_takes_the_place_of_that_in_a_volumetric_file(job, tmp_path, elsewhere):
    of_volumetric_machine(job)
    table, turned = job.with_name("drawn.csv"), job.with_name("turned.csv")
    for path, unit in ((table, "um"), (turned, "urad")):
        path.write_text(f"position_mm,forward_{unit},backward_{unit}\n-400,0,0\n0,8,8\n")
    (tmp_path / "other").mkdir()
    out = tmp_path / "other" / "new.toml" if elsewhere else None
    words = [f"EXX={table}", f"ECX={turned}", "EXX.measured_at_mm=1,2,3"]
    made, _ = set_values(job, words, out=out)
    new, again = read_job(made).machine, made.with_name("again.toml")
    where, way = np.array([-200.0]), np.ones(1)
    assert new.components["EXX"].evaluate(where, way) == pytest.approx(4e-3)
    assert new.components["EXX"].measured_at_mm.tolist() == [1, 2, 3]
    assert new.components["ECX"].evaluate(where, way) == pytest.approx(4e-6)
    set_values(made, [f"EXX={table}"], out=again)  # once more: it is left out once
    assert read_job(again).machine.components["EXX"].measured_at_mm.tolist() == [1, 2, 3]


def test_the_rest_of_a_volumetric_file_stays(job):
    of_volumetric_machine(job)
    old = read_job(job).machine
    made, _ = set_values(job, ["EXX.measured_at_mm=1,2,3"])
    new = read_job(made).machine
    assert new.components["EXX"].measured_at_mm.tolist() == [1, 2, 3]
    assert new.components["EXX"].mean.tolist() == old.components["EXX"].mean.tolist()
    table = job.with_name("drawn.csv")
    table.write_text("position_mm,forward_um,backward_um\n-400,0,0\n0,8,8\n")
    made, _ = set_values(job, [f"EXX={table}"])
    new = read_job(made).machine
    assert new.components["EXX"].measured_at_mm.tolist() == [7, 8, 9]  # where the file has it
    assert new.components["ECX"].mean.tolist() == [2e-6, 4e-6]


def test_a_job_in_another_folder_finds_its_files(job, tmp_path):
    folder = tmp_path / "elsewhere" / "deep"
    folder.mkdir(parents=True)
    made, machine = set_values(job, ["EXX.measured_at_mm=1,2,3"], out=folder / "new.toml")
    assert made.parent == machine.parent == folder
    assert read_job(made).program.read_bytes() == read_job(job).program.read_bytes()


@pytest.mark.parametrize("words", [
    ["backlash:X.reversal_um=3", "backlash:Y.reversal_um=3", "backlash:X.reversal_um=4"],
    ["EXX.measured_at_mm=1,2,3", "EXX.measured_at_mm=4,5,6"],
    ["EXX=a.csv", "EXX=b.csv"],
])  # fmt: skip
def test_a_value_is_told_once(job, words):
    with pytest.raises(InputError) as caught:
        set_values(job, words)
    assert repr(words[0]) in caught.value.what and repr(words[-1]) in caught.value.what
    assert caught.value.accepted == "every value once"
    assert not job.with_name("job-2.toml").exists()


@pytest.mark.parametrize("is_told", [False, True])
def test_a_name_that_another_command_takes_meanwhile_is_its(job, monkeypatch, is_told):
    """The other one writes after this one has looked which name is free."""
    look, words = set_values_module._texts, ["backlash:X.reversal_um=3", "EXX.measured_at_mm=1,2,3"]
    taken = job.with_name("told.toml" if is_told else "machine-2.toml")

    def texts(*arguments):
        made = look(*arguments)
        if not taken.exists():
            taken.write_text("# another's")
        return made

    monkeypatch.setattr(set_values_module, "_texts", texts)
    if is_told:
        with pytest.raises(InputError, match="file is there already"):
            set_values(job, words, out=taken)
        assert not job.with_name("machine-2.toml").exists()
    else:
        made, machine = set_values(job, words)
        assert (made.name, machine.name) == ("job-2.toml", "machine-3.toml")
    assert taken.read_text() == "# another's"


@pytest.mark.parametrize(("word", "said"), [
    ("backlash", "'backlash'"),
    ("backlash:Y.reversal_um=much", "no number"),
    ("backlash:Y.reversal=3", "no parameter 'reversal'"),
    ("backlash:Y.reversal_um=1e9", "is out of bounds"),
    ("backlach:Y.reversal_um=3", "unknown effect 'backlach'"),
    ("EXX=nothing.csv", "nothing.csv"),
    ("EXQ=nothing.csv", "'EXQ=nothing.csv'"),
    ("EXX.measured_at_mm=1,2", "EXX.measured_at_mm=1,2"),
    ("EZZ.measured_at_mm=1,2,3", "EZZ has no table"),
    ("ECX.measured_at_mm=1,2,3", "is an angle"),
])  # fmt: skip
def test_what_cannot_be_set_is_said_and_leaves_no_file(job, word, said):
    before = sorted(job.parent.glob("[!.]*"))
    with pytest.raises(InputError) as caught:
        set_values(job, [word])
    assert said in str(caught.value)
    assert sorted(job.parent.glob("[!.]*")) == before
    assert "job-2" not in str(caught.value) and "machine-2" not in str(caught.value)
