"""The diagnosis on machines with a hidden effect that no code of the program made.

The generator has its own machine, path, contact and formulas (`tests/hidden_effects`); the
program sees files only. `tests/benchmarks/bench_hidden_effects.py` does the same by the hundred.
"""

import json

import numpy as np
import pytest

from tests.hidden_effects import program_runs
from tests.hidden_effects.experiment import make_experiment
from tests.hidden_effects.verdict import judge

NOISE_UM = 0.8
#: hidden effects, seed, outcomes that are right
CASES = {
    "healthy": ([], 31, {"right"}),
    "warm workpiece": (["workpiece_temperature"], 31, {"class"}),
    "two at once": (["servo_mismatch", "datum_shift"], 31, {"right"}),
    "foreign": (["bump_field"], 31, {"right"}),
}


def held_out_rms_um(made, job):
    """What a part that was not fitted still shows, after its own alignment."""
    residual = program_runs.predicted_um(
        job, made.folder / "check_measured.csv", program=made.folder / "check.nc"
    )
    return program_runs.aligned_rms_um(residual, made.check)


@pytest.mark.parametrize("name", CASES)
def test_verdict_parameters_and_held_out_error(tmp_path, name):
    effects, seed, outcomes = CASES[name]
    made = make_experiment(tmp_path, effects=effects, seed=seed)
    report, _ = program_runs.diagnose(tmp_path)
    found = judge(report, json.loads((tmp_path / "truth.json").read_text()))
    assert found.outcome in outcomes, found.said
    expected = sum(len(h.comparable) for h in made.hidden)
    assert len(found.parameters) == expected
    for parameter, value, u, true in found.parameters:
        assert abs(value - true) < 3 * u, parameter
        assert u < 0.2 * abs(true), parameter
    if report["verdict"] not in ("named", "class"):
        return
    before = held_out_rms_um(made, tmp_path / "job.toml")
    after = held_out_rms_um(made, program_runs.add(tmp_path, report))
    assert after < 1.2 * NOISE_UM < before
    assert np.isfinite(report["rms_um"]["expected_noise"])
