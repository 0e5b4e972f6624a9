"""Verdicts of ISO 14253-1 and their limits."""

from __future__ import annotations

import math

import pytest

from vmach.features.verdict import Verdict, verdict

#: 95 % of a normal distribution lie below its mean plus so many standard deviations
GUARD = 1.6448536269514722


@pytest.mark.parametrize(("value", "expected"), [
    (10.0 - GUARD - 1e-6, Verdict.CONFORMS), (10.0 - GUARD + 1e-6, Verdict.OPEN),
    (10.0 + GUARD - 1e-6, Verdict.OPEN), (10.0 + GUARD + 1e-6, Verdict.FAILS),
])  # fmt: skip
def test_the_guard_band_of_one_limit_is_1_645_u(value, expected):
    assert verdict(value, 1.0, -math.inf, 10.0) is expected


def test_two_limits_nearer_than_the_uncertainty_prove_nothing():
    assert verdict(0.0, 1.0, -1.0, 1.0) is Verdict.OPEN
    assert verdict(0.0, 1.0, -1.97, 1.97) is Verdict.CONFORMS


def test_without_uncertainty_the_limit_itself_conforms():
    assert verdict(10.0, 0.0, 0.0, 10.0) is Verdict.CONFORMS
    assert verdict(10.0 + 1e-12, 0.0, 0.0, 10.0) is Verdict.FAILS
