"""Whitening, evidence and joint fits against dense textbook formulas."""

from __future__ import annotations

from unittest.mock import MagicMock

import numpy as np
import pytest
from numpy.polynomial.legendre import legval
from scipy.stats import kstest, multivariate_normal

from vmach.effects.wandering import wandering
from vmach.fit.evidence import WIDTHS, evidence_at_places
from vmach.fit.noise import discrepancy
from vmach.fit.whitening import Whitening, orthonormal
from vmach.machine import read_machine
from vmach.uncertainty.tables import TableUncertainty


@pytest.fixture
def problem():
    random = np.random.default_rng(4)
    n = 60
    return {
        "u": random.uniform(0.5, 2.0, n),
        "factors": random.standard_normal((n, 7)),
        "nuisance": np.column_stack([np.ones(n), np.linspace(-1, 1, n)]),
        "columns": random.standard_normal((n, 2)),
        "y": random.standard_normal(n) * 3,
    }


def dense_covariance(problem):
    return np.diag(problem["u"] ** 2) + problem["factors"] @ problem["factors"].T


def test_whitened_least_squares_is_generalised_least_squares(problem):
    whiten = Whitening(problem["u"], problem["factors"], problem["nuisance"])
    x, y = whiten(problem["columns"]), whiten(problem["y"])
    ours = np.linalg.lstsq(x, y, rcond=None)[0]
    design = np.hstack([problem["columns"], problem["nuisance"]])
    weight = np.linalg.inv(dense_covariance(problem))
    dense = np.linalg.solve(design.T @ weight @ design, design.T @ weight @ problem["y"])
    np.testing.assert_allclose(ours, dense[:2], rtol=1e-8)
    left = problem["y"] - design @ dense
    np.testing.assert_allclose(np.sum((y - x @ ours) ** 2), left @ weight @ left, rtol=1e-8)


def test_whitened_noise_is_white(problem):
    """The whitened sum of squares follows chi-squared: its mean is the degrees of freedom."""
    whiten = Whitening(problem["u"], problem["factors"], problem["nuisance"])
    random = np.random.default_rng(9)
    root = np.linalg.cholesky(dense_covariance(problem))
    noise = whiten(root @ random.standard_normal((60, 2000)))
    total = (noise**2).sum(axis=0)
    assert kstest(total, "chi2", args=(58,)).pvalue > 0.01


def log_evidence(columns, readings, log_prior):
    """Evidence of one candidate from its signatures (n, G, K) at G places."""
    rows = columns.transpose(1, 2, 0)
    return evidence_at_places(rows @ rows.transpose(0, 2, 1), rows @ readings, [log_prior])


def test_evidence_is_the_ratio_of_dense_likelihoods():
    random = np.random.default_rng(2)
    n, x, y = 25, random.standard_normal((25, 3)), random.standard_normal(25) * 1.5
    plain = multivariate_normal(np.zeros(n), np.eye(n)).logpdf(y)
    ratios = [
        multivariate_normal(np.zeros(n), np.eye(n) + w**2 * x @ x.T).logpdf(y) - plain
        for w in WIDTHS
    ]
    expected = np.log(np.mean(np.exp(ratios)))
    found = log_evidence(x[:, None, :], y[:, None], np.zeros(1))
    np.testing.assert_allclose(found.log_factor[0], expected, rtol=1e-9)


def test_evidence_averages_over_the_grid_by_its_prior():
    random = np.random.default_rng(3)
    x, y = random.standard_normal((30, 4, 1)), random.standard_normal((30, 1))
    prior = np.log([0.1, 0.2, 0.3, 0.4])
    single = [log_evidence(x[:, [g]], y, np.zeros(1)).log_factor[0, 0] for g in range(4)]
    together = log_evidence(x, y, prior).log_factor[0, 0]
    np.testing.assert_allclose(together, np.log(np.exp(prior) @ np.exp(single)), rtol=1e-10)


def test_evidence_rarely_exceeds_its_bound_on_noise():
    """A Bayes factor above b has at most the chance 1/b under noise (Ville, Markov)."""
    random = np.random.default_rng(8)
    x = random.standard_normal((40, 10, 2))
    noise = random.standard_normal((40, 4000))
    factor = log_evidence(x, noise, np.full(10, -np.log(10.0))).log_factor
    for bound in (5.0, 20.0, 100.0):
        allowed = 4000 / bound
        assert (factor > np.log(bound)).sum() < allowed + 3 * np.sqrt(allowed)


def test_orthonormal_basis_spans_and_drops_copies():
    random = np.random.default_rng(1)
    x = random.standard_normal((20, 3))
    basis = orthonormal(np.hstack([x, x[:, :1] * 1e-6, np.zeros((20, 1))]))
    assert basis.shape == (20, 3)
    np.testing.assert_allclose(basis @ (basis.T @ x), x, atol=1e-9)


def test_what_rounding_leaves_of_a_column_is_no_direction():
    x = np.random.default_rng(1).normal(size=(20, 3))
    first = orthonormal(x[:, :1])
    left = x - first @ (first.T @ x)
    assert 0.0 < np.abs(left[:, 0]).max() < 1e-14
    assert orthonormal(left).shape == (20, 2)


def test_table_uncertainty_is_read_off_the_tables(tmp_path):
    """Noise of 0.3 um a direction, and the known bend of a parabola."""
    random = np.random.default_rng(6)
    position = np.arange(-800.0, 1.0, 20.0)
    curve = 40.0 * (position / 400.0) ** 2
    lines = ["position_mm,forward,backward"]
    for x, value in zip(position, curve, strict=True):
        a, b = value + 0.3 * random.standard_normal(2)
        lines.append(f"{x},{a + 1.0},{b - 1.0}")
    (tmp_path / "EXX.csv").write_text("\n".join(lines))
    (tmp_path / "machine.toml").write_text(
        'schema = 1\nname = "m"\nchain = "t (C) Z Y b X\' w"\n[convention]\nsign = "relative"\n'
        'length = "um"\nangle = "urad"\n[motion]\nrapid_mm_min = 1000\n[axes.X]\n'
        "travel_mm = [-800, 0]\n[axes.Y]\ntravel_mm = [-500, 0]\n[axes.Z]\ntravel_mm = [-400, 0]\n"
        '[errors.EXX]\ntable = "EXX.csv"\nmeasured_at_mm = [0, 0, 0]\n'
    )
    found = TableUncertainty.of(read_machine(tmp_path / "machine.toml"))
    np.testing.assert_allclose(found.reading_mm, 0.3e-3 / np.sqrt(2), rtol=0.25)
    # f'' h^2 / 8 of the parabola: 40 um x 2 / 400^2 x 20^2 / 8
    np.testing.assert_allclose(np.mean(found.bend["EXX"]), -0.025e-3, atol=0.02e-3)
    assert found.bend_apart["EXX"] < 0.06e-3


@pytest.mark.parametrize("length", [1500.0, 600.0, 200.0])
def test_wandering_has_the_covariance_of_its_process(length):
    """Matern 3/2."""
    place = np.linspace(0.0, 3000.0, 181)
    waves = wandering(place, length)
    apart = np.sqrt(3.0) * np.abs(np.subtract.outer(place, place)) / length
    np.testing.assert_allclose(waves @ waves.T, (1.0 + apart) * np.exp(-apart), atol=0.07)


def test_wandering_of_very_many_lengths_keeps_half_its_variance():
    waves = wandering(np.linspace(0.0, 3000.0, 1801), 12.0)
    variance = np.einsum("pk,pk->p", waves, waves)
    assert variance.min() > 0.49 and variance.max() < 1.0 + 1e-9


@pytest.mark.parametrize("count", [9, 10])
def test_slope_and_bend_of_a_feature_are_legendre_polynomials(count):
    """Of unit variance along it; one of two readings has none."""
    group = np.array(["wall"] * count + ["pair"] * 2)
    part = MagicMock(contacts=None)
    part.__len__.return_value = len(group)
    survey = MagicMock(groups=np.unique(group, return_inverse=True), measurements=[part])
    survey.__len__.return_value = len(group)
    forms = discrepancy._forms(survey)
    place = np.linspace(-1.0, 1.0, count)
    bend = forms[:count, 3]
    np.testing.assert_allclose(forms[:count, 1], np.sqrt(3.0) * place, atol=1e-12)
    np.testing.assert_allclose(bend, np.sqrt(5.0) * legval(place, [0.0, 0.0, 1.0]), atol=1e-12)
    assert not forms[count:].any()
