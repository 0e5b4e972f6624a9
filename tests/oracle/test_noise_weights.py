"""Readings that weigh less, against Student's t."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm, t

from vmach.fit.noise.feature_noise import FeatureNoise
from vmach.fit.noise.heavy_tails import log_prior_of_weights, weights_of


@pytest.mark.parametrize("degrees", [3.0, 5.0, 10.0])
def test_expected_weights_make_readings_as_probable_as_students_t(degrees):
    away = np.array([-6.0, -1.0, 0.0, 0.3, 2.5])
    weight = (degrees + 1.0) / (degrees + away**2)
    normal = norm.logpdf(away, scale=1.0 / np.sqrt(weight)).sum()
    ours = normal + log_prior_of_weights(weight, degrees)
    assert ours == pytest.approx(t.logpdf(away, degrees).sum(), rel=1e-12)


def test_other_weights_make_them_less_probable():
    degrees = 3.0
    true = t.logpdf(4.0, degrees)
    for weight in (0.05, 0.5, 1.0):
        normal = norm.logpdf(4.0, scale=1.0 / np.sqrt(weight))
        assert normal + log_prior_of_weights(np.array([weight]), degrees) < true


@pytest.mark.parametrize("degrees", [3.0, 5.0, 10.0, np.inf])
def test_readings_say_less_than_their_weights_let_them_say(degrees):
    """The information of Student's t about its mean, by quadrature, beside the mean weight."""

    def squared_slope(away: float) -> float:
        step = 1e-4
        slope = t.logpdf(away + step, degrees) - t.logpdf(away - step, degrees)
        return (slope / (2 * step)) ** 2 * t.pdf(away, degrees)

    information = quad(squared_slope, -60.0, 60.0, limit=200, points=[0.0])[0]
    weight = quad(
        lambda away: (
            (degrees + 1.0) / (degrees + away**2) * t.pdf(away, degrees)
            if np.isfinite(degrees)
            else norm.pdf(away)
        ),
        -60.0,
        60.0,
        points=[0.0],
    )[0]
    one = np.ones(1)
    widening = FeatureNoise(one, np.full(1, "one"), one, degrees=degrees).widening
    assert widening**2 == pytest.approx(weight / information, rel=1e-3)


def test_a_slope_beside_heavy_tails_is_as_uncertain_as_is_said():
    """200 sets of readings whose tails the weights have to find."""
    random, count = np.random.default_rng(1), 300
    group, away = np.full(count, "one"), []
    for _ in range(200):
        place, read = random.uniform(-1.0, 1.0, count), random.standard_t(3, count)
        weight, degrees, slope = np.ones(count), np.inf, 0.0
        for _ in range(5):
            slope = (weight * place) @ read / (weight @ place**2)
            weight, _, degrees = weights_of(read - slope * place, group)
        factor = np.sqrt(weight @ (read - slope * place) ** 2 / count)
        noise = FeatureNoise(np.full(count, factor), group, weight, degrees=degrees)
        away.append(slope / (factor * noise.widening / np.sqrt(weight @ place**2)))
    # the root mean square of 200 normal ones lies within 0.9 and 1.1, by chi-squared of 95 %
    assert 0.9 < np.sqrt(np.mean(np.square(away))) < 1.1
