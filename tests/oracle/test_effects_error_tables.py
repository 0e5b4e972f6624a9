"""Tables that do not hold, against machine files that say what is true instead."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.hidden_effects.experiment import make_experiment
from tests.hidden_effects.program_runs import diagnose
from tests.small_job import write_job
from vmach.effects import Circumstances, catalogue
from vmach.job import read_job
from vmach.run.pipeline import predict_points

SQUARE = "[squareness]\nEC0Y = {}\n"
#: curves in um and urad, and where the reflectors stood
CURVES = {
    "EXX": (lambda q: 9.0 * math.sin(q / 30.0), (0.0, -150.0, -80.0)),
    "EYX": (lambda q: 1e-3 * (q + 200.0) ** 2, (10.0, 0.0, -120.0)),
    "EBX": (lambda q: 0.2 * q, None),
    "EYY": (lambda q: 6.0 * math.cos(q / 40.0), (0.0, 0.0, -90.0)),
}


def deviation_um(folder, curves, square_urad, effects=""):
    folder.mkdir()
    square = SQUARE.format(square_urad) if square_urad else ""
    job = write_job(folder, curves, squareness=square, more=effects)
    _, prediction = predict_points(job, folder / "points.csv")
    assert prediction.is_cut.all()
    return 1e3 * prediction.deviation_mm


def times(factor, *names):
    return {
        name: ((lambda q, c=curve: factor * c(q)) if name in names else curve, at)
        for name, (curve, at) in CURVES.items()
    }


@pytest.mark.parametrize(
    ("target", "share", "curves", "square_urad"),
    [
        ("EXX", -2.0, times(-1.0, "EXX"), 40.0),
        ("EBX", -2.0, times(-1.0, "EBX"), 40.0),
        ("EYY", -1.0, times(0.0, "EYY"), 40.0),
        ("tables", -2.0, times(-1.0, *CURVES), 40.0),
        ("all", -2.0, times(-1.0, *CURVES), -40.0),
        ("all", -1.0, {}, 0.0),
    ],
)
def test_a_share_is_as_if_the_file_said_it(tmp_path, target, share, curves, square_urad):
    effect = f"[effects.error_tables.{target}]\nshare = {share}\n"
    found = deviation_um(tmp_path / "effect", CURVES, 40.0, effect)
    true = deviation_um(tmp_path / "true", curves, square_urad)
    np.testing.assert_allclose(found, true, atol=2e-3)
    as_told = deviation_um(tmp_path / "told", CURVES, 40.0)
    assert np.abs(as_told - true).max() > 1.0


def test_what_the_file_does_not_have_is_not_asked_for(tmp_path):
    job = read_job(write_job(tmp_path, {"EXX": CURVES["EXX"]}))
    path, law = Circumstances(None, job), catalogue()["error_tables"]
    told = {target: law.not_testable(path, target) for target in law.targets}
    assert [target for target, why in told.items() if why is None] == ["all", "EXX"]
    assert told["EYY"] == "the machine file has no table EYY"
    assert told["tables"] == "the machine file has no squareness beside its tables"


@pytest.mark.parametrize(
    ("kind", "target", "share"),
    [("reversed_table", "EXX", -2.0), ("compensated_tables", "tables", -1.0)],
)
def test_tables_that_do_not_hold_are_told(tmp_path, kind, target, share):
    """By a generator that shares no code with the program."""
    make_experiment(tmp_path, effects=[kind], seed=3)
    report, _ = diagnose(tmp_path)
    (found,) = report["effects"]
    assert (found["effect"], found["target"]) == ("error_tables", target)
    low, high = found["interval_95"]["share"]
    assert low < share < high and high - low < 0.5
