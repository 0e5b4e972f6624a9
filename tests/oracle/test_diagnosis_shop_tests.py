"""The generator of plates and axes against least squares and the definitions of ISO 230-2."""

import json

import numpy as np
import pytest

from tests.hidden_effects.shop_tests import make_axis, make_plate

#: standard uncertainties within which a mean has to lie; chance alone exceeds them once in 16,000
SURE = 4.0


def test_plates_are_strained_as_is_told(tmp_path):
    """Scale along X and Y, and squareness: what a turn does not change of the linear part.

    The scatter of a plate may hold a linear part, of s / d at most by Cauchy and Schwarz. Over
    plates it has any sign, and the regression on what is told is one.
    """
    told, seen = [], []
    for seed in range(40):
        folder = tmp_path / str(seed)
        make_plate(folder, seed)
        truth = json.loads((folder / "truth.json").read_text())
        table = np.loadtxt(folder / "holes.csv", delimiter=",", skiprows=1)
        place, away = table[:, :2], table[:, 2:] - table[:, :2]
        columns = np.column_stack([np.ones(len(place)), place])
        fitted = np.linalg.lstsq(columns, away, rcond=None)[0][1:].T
        told.append(_plain(np.array(truth["strain"])))
        seen.append(_plain(fitted))
    told, seen = np.array(told), np.array(seen)
    slope, u = _regression(told.ravel(), seen.ravel())
    assert u < 0.1 and slope == pytest.approx(1.0, abs=SURE * u)


def _plain(strain):
    return strain[0, 0], strain[1, 1], strain[0, 1] + strain[1, 0]


def _regression(x, y):
    """Slope through zero and its standard uncertainty."""
    slope = float(x @ y / (x @ x))
    return slope, float(np.sqrt(np.mean((y - slope * x) ** 2) / (x @ x)))


@pytest.mark.parametrize("seed", range(8))
def test_an_axis_has_the_mean_reversal_value_that_is_told(tmp_path, seed):
    """ISO 230-2: mean over the stops of the means from below less those from above, sign turned."""
    make_axis(tmp_path / "axis", seed)
    truth = json.loads((tmp_path / "axis" / "truth.json").read_text())
    rows = np.loadtxt(tmp_path / "axis" / "laser.csv", delimiter=",", skiprows=1)
    values = rows[:, 4]
    up, down = ([values[(rows[:, 2] == s) & (rows[:, 1] == p)] for p in np.unique(rows[:, 1])]
                for s in (1, -1))  # fmt: skip
    differences = np.array([d - u for u, d in zip(up, down, strict=True)])  # stop, run
    chance = differences - differences.mean(axis=1, keepdims=True)
    runs = differences.shape[1]
    u = np.sqrt(np.sum(chance**2) / (len(differences) * (runs - 1)) / differences.size)
    assert differences.mean() == pytest.approx(truth["reversal_um"], abs=SURE * u)
