"""Waves of unknown period, against brute force and hidden causes."""

import numpy as np
import pytest

from tests.unit.test_diagnosis_verdicts import tip_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.proposals.form_columns import FormColumns
from vmach.diagnosis.proposals.held_out import held_out_um
from vmach.diagnosis.proposals.states import DIRECTIONS
from vmach.diagnosis.proposals.wave_fits import WaveFits
from vmach.diagnosis.proposals.waves import wave_states
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.fit.whitening import orthonormal

ALONG_Y = DIRECTIONS[1]


def slow_wave(q, side, time):
    """Y goes to and fro by 6 um in 173 s; readings come in clusters, with long gaps between."""
    return np.outer(6.0 * np.sin(2 * np.pi * time / 173.0), [0.0, 1.0, 0.0])


@pytest.fixture
def clustered(tmp_path):
    """A survey whose times have gaps, what is left of it, and how it senses Y."""
    file = tip_job(tmp_path, lambda q, side, time: 0.0 * q, count=120)
    rows = (tmp_path / "tip.csv").read_text().splitlines()
    time = np.repeat(400.0 * np.arange(12), 10) + np.tile(9.0 * np.arange(10), 12)
    random = np.random.default_rng(5)
    told = [rows[0]]
    for row, now in zip(rows[1:], time, strict=True):
        cells = row.split(",")
        wave = slow_wave(None, None, now)[0][1]
        cells[1], cells[9] = repr(float(now)), repr(float(wave + 0.5 * random.standard_normal()))
        told.append(",".join(cells))
    (tmp_path / "tip.csv").write_text("\n".join(told))
    survey = survey_job(file)
    left = survey.residual_mm - survey.aligned(survey.residual_mm[:, None])[:, 0]
    time = np.concatenate([path.time_s for path in survey.paths])
    return survey, left, time, FormColumns(survey)._sensed


def left_by_brute_force_um(survey, time, sensed, frequency):
    """What least squares with sine, cosine and alignment leaves, um."""
    turn = 2 * np.pi * frequency * time
    columns = [sensed[:, 0] * np.sin(turn), sensed[:, 0] * np.cos(turn)]
    beside = np.column_stack([*columns, survey.nuisance]) / survey.u_mm[:, None]
    reading = survey.residual_mm / survey.u_mm
    fit = np.linalg.lstsq(beside, reading, rcond=None)[0]
    return reading @ reading, np.sum((reading - beside @ fit) ** 2)


def test_gain_of_a_wave_is_what_least_squares_takes_off_beside_the_alignment(clustered):
    survey, left, time, sensed = clustered
    scale = 1.0 / survey.u_mm
    alignment = orthonormal(survey.nuisance * scale[:, None])
    own = time, sensed[ALONG_Y] * scale[:, None], left * scale
    wave = WaveFits(*(values[None] for values in own), alignment)
    _, alone = left_by_brute_force_um(survey, time, 0.0 * sensed[ALONG_Y], 0.0)
    periods = np.array([100.0, 173.0, 400.0])
    for period, gain in zip(periods, wave.gains(1.0 / periods[None])[0], strict=True):
        _, rest = left_by_brute_force_um(survey, time, sensed[ALONG_Y], 1.0 / period)
        assert gain == pytest.approx(alone - rest, rel=1e-6)


def test_a_wave_that_the_alignment_takes_up_explains_nothing():
    along, left = np.linspace(0.0, 100.0, 40), np.sin(np.arange(40.0))
    turn = 2 * np.pi * 0.05 * along
    alignment = orthonormal(np.column_stack([np.sin(turn), np.cos(turn)]))
    for sensed in (np.ones((40, 1)), np.full((40, 1), 1e-200), np.zeros((40, 1))):
        wave = WaveFits(along[None], sensed[None], left[None], alignment)
        gains = wave.gains(np.array([[0.05, 0.05]]))
        # the square of single precision over what counts as rounding, 6e-8**2 / 1e-9
        assert np.abs(gains).max() < 4e-6 * (left @ left)


def test_the_period_is_that_of_least_squares_where_readings_have_gaps(clustered):
    survey, left, time, sensed = clustered
    found = [state for state, direction in wave_states(survey, left, sensed)
             if state.kind == "wave in time" and direction == ALONG_Y]  # fmt: skip
    first = float(found[0].words.split()[3])
    trials = np.arange(60.0, 500.0, 0.25)
    rest = [left_by_brute_force_um(survey, time, sensed[ALONG_Y], 1.0 / p)[1] for p in trials]
    best = trials[int(np.argmin(rest))]
    # a 64th of a turn over the whole time
    assert abs(1.0 / first - 1.0 / best) < 1.0 / (32 * np.ptp(time))
    assert abs(first - 173.0) < 1.0


def coarse_encoder(q, side, time):
    """Within each signal period of 40 um the encoder of X errs by 3 um."""
    return np.outer(3.0 * np.sin(2 * np.pi * q[:, 0] / 0.04), [1.0, 0.0, 0.0])


def test_a_wave_of_an_encoders_signal_period_is_found(tmp_path):
    found = diagnose(survey_job(tip_job(tmp_path, coarse_encoder, count=150)))
    assert found.verdict == "unknown"
    first = found.proposals[0]
    assert first.form.formula == "a wave of 0.04 mm in X, along X"
    assert first.held_out_um[1] < 0.6  # the noise is 0.5 um
    assert "half a period further along X" in first.form.refute


def test_a_prior_holds_amounts_that_other_features_tell_nothing_of():
    """One block alone shows the second amount: without it nothing of it is foretold."""

    class Term:
        prior_width = 30.0

    class Fit:
        terms = (Term,)

        class _Columns:
            mm = np.zeros((20, 2))

        signatures = (_Columns,)

    random = np.random.default_rng(2)
    Fit._Columns.mm[:, 0] = 1e-3
    # rounding is all that the others show of it
    Fit._Columns.mm[:, 1] = 1e-12 * random.standard_normal(20)
    Fit._Columns.mm[:4, 1] = 1e-3

    class Survey:
        blocks = np.repeat(list("abcde"), 4)
        u_mm = np.full(20, 1e-3)
        residual_mm = Fit._Columns.mm[:, 0] + 1e-5 * random.standard_normal(20)

        def __len__(self):
            return 20

        def aligned(self, columns):
            return 0.0 * columns

    without, beside = held_out_um(Survey(), Fit, 0)
    assert without == pytest.approx(1.0, rel=0.02)
    assert beside < 0.1
