"""Noise that is correlated along features, beside its dense covariance."""

import numpy as np
import pytest

from vmach.fit.noise.feature_noise import FeatureNoise

COUNT, SHARE, CORRELATION = 400, 0.6, 0.9


@pytest.fixture(scope="module", params=["one after the other", "mixed", "one feature"])
def noise(request):
    random = np.random.default_rng(5)
    group = {
        "one after the other": np.repeat(["b", "a", "lonely", "c"], [100, 240, 1, 59]),
        "mixed": random.choice(["a", "b", "c"], COUNT),
        "one feature": np.full(COUNT, "a"),
    }[request.param]
    u_mm, weight = random.uniform(0.5e-3, 2e-3, COUNT), random.uniform(0.1, 1.0, COUNT)
    return FeatureNoise(u_mm, group, weight, SHARE, CORRELATION)


@pytest.fixture(scope="module")
def covariance(noise):
    """From the definition, in units of u."""
    place = np.zeros(COUNT)
    for name in np.unique(noise.group):
        own = noise.group == name
        place[own] = np.arange(own.sum())
    apart = np.abs(np.subtract.outer(place, place))
    same = noise.group[:, None] == noise.group
    return np.diag((1.0 - SHARE) / noise.weight) + SHARE * same * CORRELATION**apart


@pytest.fixture(params=["by rows", "by columns", "a part", "a single one"])
def columns(request):
    """As they may lie in memory."""
    some = np.random.default_rng(6).normal(size=(COUNT, 19))
    return {
        "by rows": some,
        "by columns": np.asfortranarray(some),
        "a part": some[:, 1:11],
        "a single one": some[:, 3][:, None],
    }[request.param]


def test_white_columns_have_the_products_of_the_inverse(noise, covariance, columns):
    scaled = columns / noise.u_mm[:, None]
    white = noise.white(columns)
    expected = scaled.T @ np.linalg.solve(covariance, scaled)
    np.testing.assert_allclose(white.T @ white, expected, rtol=1e-12, atol=1e-12 * expected.max())


def test_back_is_the_transpose(noise, columns):
    white = noise.white(np.eye(COUNT))
    np.testing.assert_allclose(noise.back(columns), white.T @ columns, rtol=1e-9, atol=1e-9)


def test_deviations_of_weighted_sums(noise, covariance, columns):
    scaled = columns * noise.u_mm[:, None]
    deviations = noise.deviations(columns)
    expected = np.diag(scaled.T @ covariance @ scaled)
    np.testing.assert_allclose((deviations**2).sum(axis=0), expected, rtol=1e-12)


def test_precision_of_each_given_all_others_and_determinant(noise, covariance):
    np.testing.assert_allclose(noise.precisions, np.diag(np.linalg.inv(covariance)), rtol=1e-12)
    assert noise.log_determinant == pytest.approx(np.linalg.slogdet(covariance)[1], rel=1e-12)
