"""ISO 230-2 figures against worked examples and against the definitions written out in loops."""

from __future__ import annotations

import math
import statistics
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.thesis_figures import FIGURES, PRINTED
from vmach.errors import InputError
from vmach.iso230 import Budget, evaluate, expanded, parameter_uncertainties
from vmach.iso230.uncertainty import root_sum
from vmach.machine import read_machine
from vmach.machine.tables.runs import Runs

SAMPLES = Path(__file__).parents[2] / "samples"


def test_worked_example_by_hand():
    # two targets, three runs: means 1, 4 forward and 0, 6 backward; s = 1, 2 and 0, 1
    forward = [[0, 2], [1, 4], [2, 6]]
    backward = [[0, 5], [0, 6], [0, 7]]
    result = evaluate(Runs(np.array([0.0, 100.0]), forward, backward))
    assert result.reversal.tolist() == [1, -2]
    assert (result.B, result.B_mean) == (2, -0.5)
    assert (result.E, result.E_forward, result.E_backward) == (6, 3, 6)
    assert result.M == 4.5  # 0.5 and 5
    assert (result.R_forward, result.R_backward) == (8, 4)
    assert result.R == 8  # 2*2 + 2*1 + 2 at 100 mm, and 4*2 forward
    assert result.A == 9  # 0 + ... : highest 4 + 2*2 = 8 = 6 + 2*1, lowest 1 - 2*1 = -1
    assert (result.A_forward, result.A_backward) == (9, 8)


def by_the_definitions(forward, backward):
    """Clause 3 of the standard, one target at a time, with the standard library."""
    up = [[run[i] for run in forward] for i in range(len(forward[0]))]
    down = [[run[i] for run in backward] for i in range(len(backward[0]))]
    mean_up, mean_down = [statistics.fmean(t) for t in up], [statistics.fmean(t) for t in down]
    s_up, s_down = [statistics.stdev(t) for t in up], [statistics.stdev(t) for t in down]
    reversal = [a - b for a, b in zip(mean_up, mean_down, strict=True)]
    middle = [(a + b) / 2 for a, b in zip(mean_up, mean_down, strict=True)]
    r_up, r_down = [4 * s for s in s_up], [4 * s for s in s_down]
    r = [
        max(2 * a + 2 * b + abs(c), 4 * a, 4 * b)
        for a, b, c in zip(s_up, s_down, reversal, strict=True)
    ]
    high = [m + 2 * s for m, s in zip(mean_up + mean_down, s_up + s_down, strict=True)]
    low = [m - 2 * s for m, s in zip(mean_up + mean_down, s_up + s_down, strict=True)]
    return {
        "A": max(high) - min(low), "R": max(r), "R_forward": max(r_up), "R_backward": max(r_down),
        "E": max(mean_up + mean_down) - min(mean_up + mean_down),
        "E_forward": max(mean_up) - min(mean_up), "E_backward": max(mean_down) - min(mean_down),
        "M": max(middle) - min(middle), "B": max(map(abs, reversal)),
        "B_mean": statistics.fmean(reversal),
    }  # fmt: skip


@given(st.integers(0, 2**32 - 1), st.integers(2, 6), st.integers(2, 15))
@settings(max_examples=40, deadline=None)
def test_figures_follow_the_definitions(seed, runs, targets):
    rng = np.random.default_rng(seed)
    forward, backward = rng.normal(0, 5, (2, runs, targets)).round(3)
    result = evaluate(Runs(np.arange(targets) * 50.0, forward, backward)).figures()
    for name, value in by_the_definitions(forward.tolist(), backward.tolist()).items():
        assert result[name] == pytest.approx(value, abs=1e-9)


def test_missing_readings_and_single_runs():
    forward = np.array([[1.0, 2.0], [3.0, np.nan], [5.0, 4.0]])
    result = evaluate(Runs(np.array([0.0, 10.0]), forward, forward[::-1]))
    assert result.mean_forward.tolist() == [3, 3]
    assert result.s_forward.tolist() == [2, pytest.approx(math.sqrt(2))]
    single = evaluate(Runs(np.array([0.0, 10.0]), [[1.0, 2.0]], [[0.0, 2.5]]))
    assert (single.A, single.R) == (None, None)
    assert (single.E, single.B, single.M) == (2.5, 1.0, 1.75)
    with pytest.raises(InputError, match="target 10 mm was approached from one side only"):
        evaluate(Runs(np.array([0.0, 10.0]), [[1.0, np.nan]], [[0.0, 2.5]]))


@pytest.mark.parametrize("name", PRINTED)
def test_sample_of_the_thesis_has_the_figures_of_its_tables(name):
    component = read_machine(SAMPLES / "mazak_ajv25/machine.toml").components[name]
    result = evaluate(component.runs).figures()
    factor, digit = (1e3, 5e-5) if component.is_angle else (1e3, 5e-3)
    for key, printed in zip(FIGURES, PRINTED[name], strict=True):
        # the mean reversal of EZZ is printed equal to the largest: 0.02 um is left
        slack = 0.03 if (name, key) == ("EZZ", "B_mean") else digit * 1.01
        if printed is not None:
            assert result[key] * factor == pytest.approx(printed, abs=slack), key


def test_contributors_of_the_thesis_table_8():
    budget = Budget()
    assert budget.misalignment_mm(1.0) == pytest.approx(3.608e-6, abs=5e-10)
    assert budget.setup_mm * 1e3 == pytest.approx(1.2, abs=0.05)
    assert budget.eve_u_mm * 1e3 == pytest.approx(0.87, abs=0.005)
    # printed 1.0, which its own contributors do not give
    assert budget.device_mm * 1e3 == pytest.approx(0.902, abs=5e-4)


def test_table_9_of_the_thesis():
    u = root_sum(0.67, 3.0, 1.1, 0.9)
    assert u == pytest.approx(3.4, abs=0.05)
    # printed 6.7, half a digit below twice the sum
    assert expanded(u) == pytest.approx(6.77, abs=0.005)


#: Table 7: u of R_i, B, E, R, A for X, Y, Z, um
TABLE_7 = {
    "X": (1.2, 0.6, 3.6, 1.3, 3.8), "Y": (1.2, 1.0, 2.4, 1.6, 2.7), "Z": (1.2, 1.2, 2.2, 1.7, 2.5),
}  # fmt: skip


@pytest.mark.parametrize("axis", TABLE_7)
def test_table_7_of_the_thesis_hangs_together(axis):
    u_r_i, u_b, u_e, u_r, u_a = TABLE_7[axis]
    assert parameter_uncertainties(Budget(), 750.0, 5)["R_i"] * 1e3 == pytest.approx(
        u_r_i, abs=0.05
    )
    # eq. 36 and 39, within the rounding of the printed numbers
    assert root_sum(u_b, u_r_i) == pytest.approx(u_r, abs=0.1)
    assert root_sum(u_e, u_r_i) == pytest.approx(u_a, abs=0.1)


def test_what_of_table_7_follows_from_table_8():
    # u(B) is printed per axis although nothing in Table 8 depends on the axis there: only X fits
    lengths = {"X": 750.0, "Y": 375.0, "Z": 275.0}
    ours = {a: parameter_uncertainties(Budget(), lengths[a], 5) for a in lengths}
    assert ours["X"]["B"] * 1e3 == pytest.approx(TABLE_7["X"][1], abs=0.06)
    assert abs(ours["Z"]["B"] * 1e3 - TABLE_7["Z"][1]) > 0.5
    # u(E): below the printed one on every axis, by at most 0.5 um
    for axis, u in ours.items():
        assert 0.2 < TABLE_7[axis][2] - u["E"] * 1e3 < 0.5
    # U(E) = 2 u(E) holds for Y only: 6.2 and 4.0 are printed for X and Z
    assert [expanded(TABLE_7[a][2]) for a in "XYZ"] == pytest.approx([7.2, 4.8, 4.4])


def test_uncertainty_grows_as_it_must():
    short, long = (parameter_uncertainties(Budget(), length, 5) for length in (100.0, 1000.0))
    assert long["E"] > short["E"]
    assert long["B"] == short["B"]
    more = parameter_uncertainties(Budget(), 100.0, 20)
    assert more["B"] == pytest.approx(short["B"] / 2)
    with pytest.raises(InputError, match="eve_mm = -1"):
        Budget(eve_mm=-1.0)
