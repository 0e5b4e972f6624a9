"""Readings that weigh less, against Student's t."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import norm, t

from vmach.fit.noise.heavy_tails import log_prior_of_weights


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
