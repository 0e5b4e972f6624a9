"""Uncertainties that one test states wrong: covariance as a whole matrix, scales by a search."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from vmach.fit.noise.feature_noise import FeatureNoise
from vmach.fit.noise.own_scale import AS_STATED, OwnScale, own_scale_of

COUNT = 120
#: an uncertainty is right within a factor of two beforehand
LOG_FACTOR = np.log(2.0)


@pytest.mark.parametrize("share", [0.0, 0.6])
def test_covariance_is_that_of_uncertainties_times_their_scales(share):
    random = np.random.default_rng(3)
    u_mm, weight = random.uniform(0.5e-3, 2e-3, COUNT), random.uniform(0.1, 1.0, COUNT)
    scale = np.repeat([0.2, 1.0, 4.0], [30, 40, 50])
    group = np.repeat(["a", "b", "c"], [30, 40, 50])
    noise = FeatureNoise(u_mm, group, weight, share, 0.9, own_scale=OwnScale(scale))
    apart = np.abs(np.subtract.outer(np.arange(COUNT), np.arange(COUNT)))
    alike = share * (group[:, None] == group) * 0.9**apart
    in_u = scale[:, None] * (np.diag((1.0 - share) / weight) + alike) * scale
    in_mm2 = u_mm[:, None] * in_u * u_mm
    columns = random.normal(size=(COUNT, 4))
    white = noise.white(columns)
    expected = columns.T @ np.linalg.solve(in_mm2, columns)
    np.testing.assert_allclose(white.T @ white, expected, rtol=1e-9, atol=1e-10 * expected.max())
    assert noise.log_determinant == pytest.approx(np.linalg.slogdet(in_u)[1], rel=1e-10)
    deviations = (noise.deviations(columns) ** 2).sum(axis=0)
    np.testing.assert_allclose(deviations, np.diag(columns.T @ in_mm2 @ columns), rtol=1e-10)
    precise = np.diag(np.linalg.inv(in_mm2)) * noise.shown_mm**2
    np.testing.assert_allclose(noise.precisions, precise, rtol=1e-9)


def test_scales_are_the_most_probable_ones_of_what_tests_leave():
    quantile = np.linspace(-0.995, 0.995, 200)
    size = np.array([0.3, 1.0, 5.0])
    left = np.concatenate([s * quantile for s in size])  # medians of the absolute: s times 0.4975
    rows = [slice(200 * k, 200 * (k + 1)) for k in range(3)]
    shown = np.log(np.median(np.abs(quantile)) * size / 0.6745)

    def unlikely(shared: np.ndarray) -> float:
        return float(shared[0] ** 2 + np.sum((shown - shared[0]) ** 2))

    expected = np.exp(shown - minimize(unlikely, [0.0], tol=1e-12).x)
    found = own_scale_of(left, rows)
    np.testing.assert_allclose(found.of_readings, np.repeat(expected, 200), rtol=1e-5)
    log_prior = -0.5 * np.sum((np.log(expected) / LOG_FACTOR) ** 2)
    assert found.log_prior == pytest.approx(log_prior, rel=1e-4)


def test_few_readings_say_nothing_of_their_scale():
    left = np.random.default_rng(4).normal(size=60)
    left[:19] *= 10.0
    assert own_scale_of(left, [slice(0, 19), slice(19, 60)]) is AS_STATED
    found = own_scale_of(left, [slice(0, 19), slice(19, 39), slice(39, 60)])
    assert np.all(found.of_readings[:19] == 1.0)
    assert np.any(found.of_readings[19:] != 1.0)
