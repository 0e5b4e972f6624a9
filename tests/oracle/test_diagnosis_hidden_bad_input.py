"""Measured files as they come from a workshop: the diagnosis says what is wrong, and survives."""

import json
import shutil

import pytest

from tests.hidden_effects import program_runs
from tests.hidden_effects.experiment import make_experiment
from tests.hidden_effects.spoil import spoil
from tests.hidden_effects.verdict import judge


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    """An experiment with lost motion, nothing spoilt."""
    folder = tmp_path_factory.mktemp("sound")
    make_experiment(folder, effects=["backlash"], seed=61)
    return folder


@pytest.fixture
def folder(sound, tmp_path):
    """A copy to spoil."""
    return shutil.copytree(sound, tmp_path / "experiment")


@pytest.mark.parametrize(
    ("how", "share", "word"),
    [
        ("chips", 0.03, "left out"),
        ("repeated", 0.02, "repeat"),
        ("never_cut", 0.02, "no move cut"),
    ],
)
def test_some_bad_rows_are_said_and_the_verdict_survives(folder, how, share, word):
    count = spoil(folder, how, seed=5, share=share)
    report, _ = program_runs.diagnose(folder)
    notes = " ".join(report["notes"])
    assert word in notes
    if how != "chips":  # the smallest chips lie within the noise
        assert f"{count} " in notes
    found = judge(report, json.loads((folder / "truth.json").read_text()))
    assert found.outcome == "right", found.said
    (_, value, low, high, true) = found.parameters[0]
    assert abs(value - true) < 1.5 * (high - low) / 2


@pytest.mark.parametrize(
    ("how", "word"),
    [
        ("metres", "metres"),
        ("inches", "inches"),
        ("measured_in_metres", "metres"),
        ("uncertainty_in_mm", "u_um"),
        ("uncertainty_in_metres", "u_um"),
    ],
)
def test_a_wrong_unit_is_refused_by_its_name(folder, how, word):
    spoil(folder, how)
    with pytest.raises(RuntimeError, match=r"exit 1\n.*part_measured\.csv") as error:
        program_runs.diagnose(folder)
    assert word in str(error.value)


def test_the_measurement_of_another_part_is_refused(folder):
    shutil.copy(folder / "check_measured.csv", folder / "part_measured.csv")
    with pytest.raises(RuntimeError, match=r"is this the measurement of this part|part.s program"):
        program_runs.diagnose(folder)
