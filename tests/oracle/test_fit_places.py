"""Products at many moments, against those of the whole covariance matrix of the readings."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from vmach.effects import Effect
from vmach.effects.parameter import inner, linear
from vmach.fit.base import Base
from vmach.fit.joint_fit import taken_off
from vmach.fit.marginal_likelihood import Effects, Posterior
from vmach.fit.noise.discrepancy import Members
from vmach.fit.noise.feature_noise import FeatureNoise
from vmach.fit.sizes import Sizes

RANDOM = np.random.default_rng(5)
COUNT, FACTOR, SIZE = 60, 1.3, 0.7
TIME_S = np.sort(RANDOM.uniform(0.0, 100.0, COUNT))
U_MM = RANDOM.uniform(0.5e-3, 1.5e-3, COUNT)
FEATURE = np.where(np.arange(COUNT) % 3 == 0, "wall", "floor")
WEIGHT = RANDOM.uniform(0.3, 1.0, COUNT)
MOMENTS_S = [10.0, 10.001, 33.0, 34.0, 71.0, 70.0]


class Jump(Effect):
    """Two amplitudes that act from a moment on."""

    name = "jump"
    title = "jump"
    is_sudden = True
    needs_surface = True
    parameters = (
        linear("x_um", "first", usual=10.0),
        linear("y_um", "second", usual=10.0),
        inner("time_s", "moment", (0.0, 1e6), usual=10.0, spread=np.inf),
    )

    def displacement(self, path, target, x_um, y_um, time_s):
        raise NotImplementedError("the series says what it does")


class Series:
    """One series of readings with one amount left free."""

    residual_mm = RANDOM.normal(size=COUNT) * 1e-3
    nuisance = np.linspace(-1.0, 1.0, COUNT)[:, None]

    def __init__(self, time_s):
        self.time_s = time_s

    def __len__(self):
        return COUNT

    def signature(self, effect, target, values):
        after = values["time_s"] < self.time_s
        return 0.01 * after[:, None] * np.stack([np.ones(COUNT), np.cos(self.time_s)], axis=1)

    def told_apart(self, effect, inner):
        moments = np.array([values["time_s"] for values in inner])
        passed = (self.time_s[:, None] <= moments).sum(axis=0)
        return np.append(True, np.diff(passed) != 0)


def covariance(share, correlation):
    """Of the readings, in mm²: between any two of them, those of one feature in their order."""
    found = np.zeros((COUNT, COUNT))
    for feature in np.unique(FEATURE):
        rows = np.flatnonzero(feature == FEATURE)
        for i, here in enumerate(rows):
            for j, there in enumerate(rows):
                common = share * correlation ** abs(i - j)
                alone = (1.0 - share) / WEIGHT[here] if i == j else 0.0
                found[here, there] = U_MM[here] * U_MM[there] * (common + alone)
    return found


@pytest.mark.parametrize(("share", "correlation"), [(0.0, 0.0), (0.6, 0.8)])
def test_products_at_all_moments_are_those_of_the_covariance_matrix(share, correlation):
    survey = Series(TIME_S)
    noise = FeatureNoise(U_MM, FEATURE, WEIGHT, share, correlation)
    wave = 1e-3 * np.sin(np.arange(COUNT) / 9.0)[:, None]
    beside = 1e-3 * np.cos(survey.time_s / 17.0)[:, None]
    base = Base(survey, noise, Members(np.zeros((COUNT, 0)), ("wave",), (wave,)))
    posterior = Posterior(base, Sizes(FACTOR, (SIZE,)), Effects(base.columns(beside)))
    moments = [{"time_s": t} for t in MOMENTS_S]
    gram, seen = posterior.products_at(base.places(Jump(), "", moments))

    # only the independent noise is wider by the factor
    whole = FACTOR**2 * covariance(share, correlation)
    whole += SIZE**2 * wave @ wave.T + beside @ beside.T
    precision = np.linalg.inv(whole)
    taken = precision @ survey.nuisance
    precision -= taken @ np.linalg.inv(survey.nuisance.T @ taken) @ taken.T
    for k, moment in enumerate(moments):
        columns = survey.signature(None, "", moment)
        assert gram[k] == pytest.approx(columns.T @ precision @ columns, rel=1e-8)
        assert seen[k] == pytest.approx(columns.T @ precision @ survey.residual_mm, rel=1e-8)


@pytest.mark.parametrize("is_size", [(True,), (False,), (True, True), (True, False)])
def test_sizes_above_zero_take_off_what_bounded_least_squares_does(is_size):
    """Against scipy's least squares with bounds, place by place."""
    rng, count = np.random.default_rng(5), len(is_size)
    columns, readings = rng.normal(size=(200, 12, count)), rng.normal(size=(200, 12))
    columns[..., -1] += 2.0 * columns[..., 0]  # so alike that each takes what is the other's
    gram = columns.transpose(0, 2, 1) @ columns
    seen = (columns.transpose(0, 2, 1) @ readings[:, :, None])[:, :, 0]
    ours = taken_off(gram, seen, np.array(is_size))
    low = np.where(is_size, 0.0, -np.inf)
    for own, y, half in zip(columns, readings, ours, strict=True):
        left = lsq_linear(own, y, (low, np.inf), tol=1e-14).cost
        # scipy goes to the bounds in steps, and stops near them
        assert half == pytest.approx(0.5 * y @ y - left, abs=1e-7)
