"""Spots and stretches of time whose place nobody knows, against least squares and hidden causes."""

import re

import numpy as np

from tests.unit.test_diagnosis_verdicts import tip_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.proposals.form import USUAL_UM
from vmach.diagnosis.proposals.matched import matched_power, peaks
from vmach.diagnosis.proposals.spots import _MOST_TRIALS, _WIDTHS_MM, _Trials
from vmach.diagnosis.residuals.job_survey import survey_job


def test_matched_power_is_what_a_ridge_regression_takes_off():
    random = np.random.default_rng(3)
    columns, reading = random.normal(size=(5, 40, 2)) * 300.0, random.normal(size=40)
    seen = np.einsum("tnd,n->td", columns, reading)
    gram = np.einsum("tnd,tne->tde", columns, columns)
    for own, power in zip(columns, matched_power(seen, gram), strict=True):
        # the prior as two more readings of zero
        wide = np.vstack([own, np.eye(2) / (1e-3 * USUAL_UM)])
        long = np.append(reading, [0.0, 0.0])
        _, (left,), *_ = np.linalg.lstsq(wide, long, rcond=None)
        np.testing.assert_allclose(power, long @ long - left, rtol=1e-9)


def test_peaks_do_not_lie_in_the_same_readings():
    place = np.linspace(0.0, 10.0, 101)
    bumps = np.exp(-0.5 * (place - place[:, None]) ** 2)
    power = 5.0 * np.exp(-0.5 * (place - 2.0) ** 2) + 3.0 * np.exp(-0.5 * (place - 8.0) ** 2)
    bumps /= np.linalg.norm(bumps, axis=1)[:, None]
    assert place[peaks(power, lambda k: bumps @ bumps[k], 2)].tolist() == [2.0, 8.0]
    assert peaks(np.zeros(101), lambda k: bumps @ bumps[k], 2) == []


def bulging(q, side, time):
    """Around X-250 Y-180 the table pushes 12 um along Z and 6 um along -X."""
    away = np.hypot(q[:, 0] + 250.0, q[:, 1] + 180.0)
    return np.outer(np.exp(-0.5 * (away / 45.0) ** 2), [-6.0, 0.0, 12.0])


def test_a_bump_at_an_unknown_place_is_a_spot(tmp_path):
    found = diagnose(survey_job(tip_job(tmp_path, bulging, count=150)))
    assert found.verdict in ("unknown", "partly")
    first = found.proposals[0]
    assert first.form.kinds == {"spot"}
    wide, x, y = map(float, re.findall(r"-?\d+(?= mm)", first.form.formula)[:3])
    assert wide == 100.0 and np.hypot(x + 250.0, y + 180.0) < 25.0
    assert first.held_out_um[1] < 0.75  # the noise is 0.5 um, and widths are a factor of two apart


def pushed(q, side, time):
    """From 400 s to 800 s something pushes along X and Y."""
    now = (time >= 400.0) & (time < 800.0)
    return np.outer(now, [8.0, -5.0, 0.0])


def test_what_acts_for_a_while_is_a_stretch_of_time(tmp_path):
    found = diagnose(survey_job(tip_job(tmp_path, pushed, count=150)))
    stretch = [p.form.formula for p in found.proposals if p.form.kinds == {"stretch of time"}]
    assert stretch, [p.form.formula for p in found.proposals]
    start, end = map(float, re.search(r"from (\d+) s to (\d+) s", stretch[0]).groups())
    assert abs(start - 395.0) <= 10.0 and abs(end - 795.0) <= 10.0


def test_trials_over_a_very_large_part_take_no_more_room():
    corners = np.array([[0.0, 0.0], [6000.0, 4000.0]])
    trials = _Trials.over(corners)
    assert len(trials.widths_mm) < 1.5 * _MOST_TRIALS
    assert trials.widths_mm.min() > min(_WIDTHS_MM)
    # every place is within half a standard deviation of a centre of each width
    for width in np.unique(trials.widths_mm):
        own = trials.centres_mm[trials.widths_mm == width]
        steps = [np.diff(np.unique(own[:, k])).max() for k in range(2)]
        assert max(steps) <= 0.5 * width * (1.0 + 1e-12)
    small = _Trials.over(np.array([[0.0, 0.0], [300.0, 200.0]]))
    assert np.unique(small.widths_mm).tolist() == list(_WIDTHS_MM)
