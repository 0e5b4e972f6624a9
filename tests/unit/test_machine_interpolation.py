"""Curves through error tables against what each method must give."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline, PchipInterpolator

from vmach.errors import InputError
from vmach.machine.tables.cross_validation import CANDIDATES, choose, cross_validate
from vmach.machine.tables.interpolation import Extrapolation, Interpolation, Method

X = np.array([-800.0, -640.0, -610.0, -450.0, -300.0, -220.0, -100.0, -50.0])
Y = np.array([3.0, 1.0, 4.0, 1.0, -5.0, -9.0, 2.0, 6.0])
WITHIN = np.linspace(-800, -50, 997)


def fit(method, x=X, y=Y, extrapolation=Extrapolation.HOLD, **parameters):
    return Interpolation(method, **parameters).fit(x, y, extrapolation)


@pytest.mark.parametrize(
    ("method", "reference"),
    [
        (Method.LINEAR, lambda x: np.interp(x, X, Y)),
        (Method.PCHIP, PchipInterpolator(X, Y)),
        (Method.CUBIC, CubicSpline(X, Y)),
    ],
)
def test_methods_that_pass_through_the_points(method, reference):
    assert fit(method)(WITHIN) == pytest.approx(reference(WITHIN), abs=1e-12)


def test_smoothing_is_calmer_than_the_noise_and_near_the_truth():
    rng = np.random.default_rng(5)
    x = np.linspace(-800, -50, 61)
    truth = 5 * np.sin(x / 120)
    smooth = fit(Method.SMOOTHING, x, truth + rng.normal(0, 0.5, 61))(x)
    assert np.sqrt(np.mean((smooth - truth) ** 2)) < 0.25


def test_legendre_of_full_degree_returns_the_polynomial():
    def polynomial(x):
        return 1e-3 * x + 2e-13 * (x + 400) ** 5

    curve = fit(Method.LEGENDRE, X, polynomial(X), order=7)
    assert curve(WITHIN) == pytest.approx(polynomial(WITHIN), abs=1e-7)


def test_fourier_returns_line_and_harmonics():
    def waves(x):
        return 2 + 0.01 * x + 3 * np.cos(x / 200 * 2 * np.pi) - np.sin(3 * x / 200 * 2 * np.pi)

    x = np.linspace(-810, -40, 40)
    curve = fit(Method.FOURIER, x, waves(x), order=3, period_mm=200.0)
    assert curve(WITHIN) == pytest.approx(waves(WITHIN), abs=1e-6)


@pytest.mark.parametrize("method", [Method.LINEAR, Method.PCHIP, Method.CUBIC])
def test_beyond_the_ends(method):
    beyond = np.array([-900.0, 50.0])
    inner = np.array([-800.0, -50.0])
    assert fit(method)(beyond) == pytest.approx([3.0, 6.0])
    tangent = fit(method, extrapolation=Extrapolation.LINEAR)
    step = np.array([1e-4, -1e-4])
    slope = (tangent(inner + step) - tangent(inner)) / step
    assert tangent(beyond) == pytest.approx([3, 6] + slope * [-100, 100], abs=1e-3)


@pytest.mark.parametrize("method", list(Method))
def test_finer_breaks_leave_the_curve_as_it_is(method):
    order = 3 if method in (Method.LEGENDRE, Method.FOURIER) else None
    curve = fit(method, order=order, extrapolation=Extrapolation.LINEAR)
    finer = curve.on(np.union1d(curve.breaks, np.linspace(-1000, 100, 57)))
    there = np.linspace(-1200, 300, 3001)
    assert finer(there) == pytest.approx(curve(there), abs=1e-9)


@pytest.mark.parametrize(
    ("chosen", "part"),
    [
        (Interpolation(Method.LEGENDRE), "order None"),
        (Interpolation(Method.LEGENDRE, 8), "needs 9 points, the table has 8"),
        (Interpolation(Method.FOURIER, 4), "needs 10 points"),
    ],
)
def test_orders_that_the_points_cannot_carry(chosen, part):
    with pytest.raises(InputError, match=part):
        chosen.fit(X, Y, Extrapolation.HOLD)


def test_cross_validation_finds_the_kind_of_curve_and_keeps_the_scores():
    rng = np.random.default_rng(2)
    x = np.linspace(-800, 0, 33)
    parabola = 1e-5 * (x + 300) ** 2 + rng.normal(0, 0.05, 33)
    scores = cross_validate(x, parabola)
    assert choose(scores) == Interpolation(Method.LEGENDRE, 2)
    assert {score.interpolation for score in scores} == set(CANDIDATES)
    # leaving one of n points out of a fit by least squares: known in closed form
    basis = np.vander(x / 800, 3)
    leverage = np.einsum("ij,ji->i", basis, np.linalg.pinv(basis))
    left_out = (parabola - basis @ np.linalg.pinv(basis) @ parabola) / (1 - leverage)
    score = next(s for s in scores if s.interpolation == Interpolation(Method.LEGENDRE, 2))
    assert score.rms == pytest.approx(np.sqrt(np.mean(left_out[1:-1] ** 2)), rel=1e-6)


def test_long_tables_leave_several_points_out_at_once():
    rng = np.random.default_rng(3)
    x = np.linspace(-800, 0, 150)
    noise = rng.normal(0, 0.1, 150)
    linear = Interpolation(Method.LINEAR)
    (score,) = cross_validate(x, np.sin(x / 60) + noise, (linear,))
    # a line between two noisy neighbours: variance 1 + 1/2
    assert score.rms == pytest.approx(0.1 * np.sqrt(1.5), rel=0.15)


def test_few_points_stay_linear():
    assert choose(cross_validate(X[:2], Y[:2])) == Interpolation(Method.LINEAR)
