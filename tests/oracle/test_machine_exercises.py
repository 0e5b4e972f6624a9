"""The runnable exercises give the numbers of the teaching paper (Bhattacharyya et al., 2022)."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np
import pytest

EXERCISES = Path(__file__).parents[2] / "samples/exercises"


def load(number: int) -> dict:
    return runpy.run_path(str(EXERCISES / f"exercise{number}.py"))


def test_exercise_1_beam_with_a_probe():
    exercise = load(1)
    sag, slope = exercise["sag_and_slope"](np.array(250.0))
    # I = b h^3 / 12 = 2.6042e-7 m4; sag 9.5238 um (printed 9.54), slope 57.143 urad = 11.787"
    assert sag * 1e3 == pytest.approx(9.5238, abs=5e-5)
    assert slope * 1e6 == pytest.approx(57.143, abs=5e-4)
    assert np.degrees(slope) * 3600 == pytest.approx(11.787, abs=5e-4)
    # lateral error downwards, Abbe error 5.714 um back towards the wall
    assert exercise["tip_error_um"]() == pytest.approx([-5.7143, 0.0, -9.5238], abs=1e-4)


def test_exercise_2_matrix():
    matrix = load(2)["matrix"]
    errors = {"EXZ": 1.0, "EYZ": 2.0, "EZZ": 3.0, "EAZ": 4.0, "EBZ": 5.0, "ECZ": 6.0}
    expected = [[1, -6, 5, 1], [6, 1, -4, 102], [-5, 4, 1, 203], [0, 0, 0, 1]]
    assert matrix(errors, 100.0, 200.0).tolist() == expected


def test_exercise_3_table_2():
    exercise = load(3)
    found = exercise["errors_at_b_um"]()
    assert np.round(found[:, 1]).astype(int).tolist() == [0, 8, 60, 81, 76, 17, -18, -47, -54]
    assert found[3] == pytest.approx([9.9570, 81.2487, -69.3132], abs=5e-5)


@pytest.mark.parametrize("number", [1, 2, 3])
def test_each_prints_its_table(number, capsys):
    load(number)["main"]()
    assert len(capsys.readouterr().out.splitlines()) >= 5
