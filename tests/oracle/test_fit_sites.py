"""Readings taken again at the same sites: what is worked out once a site, against all of them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from vmach.base.alike_rows import alike_rows
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import catalogue

SAMPLE = Path(__file__).parents[2] / "samples" / "missing_effect"


@pytest.fixture(scope="module")
def single():
    """A survey in which hardly a reading repeats another one."""
    return survey_job(SAMPLE)


@pytest.fixture(scope="module")
def repeated(single):
    """Every reading three times."""
    measurements = tuple(m.keep(np.repeat(np.arange(len(m)), 3)) for m in single.measurements)
    return replace(single, measurements=measurements)


def test_rows_are_alike_where_all_values_are():
    first, of = alike_rows([np.array([3, 1, 3, 3]), np.array([[0.0], [2.0], [0.0], [1.0]])])
    assert first.tolist() == [0, 1, 3]
    assert of.tolist() == [0, 1, 0, 2]


def test_few_repeated_readings_have_no_sites(single):
    assert single.sites is None


def test_signatures_factors_and_slack_are_those_of_every_reading(single, repeated):
    assert len(repeated.sites.first) <= len(single) == len(repeated) / 3
    again = np.repeat(np.arange(len(single)), 3)
    effects = [(e, t) for e in catalogue().values() for t in e.possible_targets(single.job)]
    compared, probe = 0, np.random.default_rng(3).normal(size=(len(repeated), 4))
    for effect, target in effects:
        if single.not_testable(effect, target) is None and single.inner_grid(effect, target):
            inner = single.inner_grid(effect, target)[-1]
            whole = single.signature(effect, target, inner)[again]
            assert np.allclose(repeated.signature(effect, target, inner), whole, 1e-12, 1e-15)
            usual = {p.name: p.usual for p in effect.parameters if np.isfinite(p.usual)}
            slack = repeated.slack_at_sites(effect, target, usual | inner)
            slack = repeated.at_readings(slack)
            # condensed: what adds less than a thousandth of u² to a direction is left out
            full = repeated._slack(effect, target, usual | inner, repeated.u_mm)
            apart = slack @ (slack.T @ probe) - full @ (full.T @ probe)
            assert np.abs(apart).max() < 1e-9 * repeated.u_mm.max() ** 2
            compared += 1
    assert compared > 20
    assert np.allclose(repeated.factors, single.factors[again], 1e-12, 1e-15)
