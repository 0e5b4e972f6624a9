"""The error of features that were not fitted, against the closed form of left-out groups.

Source: R. D. Cook and S. Weisberg, Residuals and Influence in Regression (1982), section 2.2 with
several cases: the residual of rows that were left out is (1 - H_kk)^-1 times their residual in the
fit to all, H the hat matrix.
"""

import numpy as np
import pytest

from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.history.held_out import held_out_rms_um
from vmach.history.history import rms_um

REVERSAL_UM = 5.5


@pytest.fixture(scope="module")
def surveys(measured_folder):
    """Of the job as it is, and with an effect that was fitted to it."""
    job = measured_folder / "fitted.toml"
    job.write_text(
        (measured_folder / "job.toml").read_text()
        + f"\n[effects.backlash.Y]\nreversal_um = {REVERSAL_UM}\n"
        '\n[[fitted]]\neffect = "backlash"\ntarget = "Y"\none_sigma = [{reversal_um = 0.1}]\n'
    )
    found = survey_job(measured_folder / "job.toml"), survey_job(job)
    job.unlink()
    return found


def aligned(survey, values):
    """Values less what the pose of the part explains, all readings of one uncertainty."""
    free = np.linalg.lstsq(survey.nuisance, values, rcond=None)[0]
    return values - survey.nuisance @ free


def test_features_are_foretold_as_the_hat_matrix_says(surveys):
    plain, fitted = surveys
    column = aligned(plain, plain.residual_mm - fitted.residual_mm)[:, None]  # what the effect does
    target = aligned(plain, plain.residual_mm)
    hat = column @ np.linalg.pinv(column)
    residual = target - hat @ target
    groups, number = np.unique(plain.group, return_inverse=True)
    fold = np.random.default_rng(0).permutation(len(groups))[number] % 5
    left = np.empty(len(target))
    for part in range(5):
        rows = np.flatnonzero(fold == part)
        left[rows] = np.linalg.solve(np.eye(len(rows)) - hat[np.ix_(rows, rows)], residual[rows])
    wanted = 1e3 * np.sqrt(np.mean(left**2))
    found = held_out_rms_um(fitted)
    assert found == pytest.approx(wanted, rel=1e-3)
    assert found > rms_um(fitted, 0.0) * 0.9 and found < 0.7 * rms_um(plain)


def test_nothing_fitted_nothing_held_out(surveys):
    plain, _ = surveys
    assert held_out_rms_um(plain) == pytest.approx(rms_um(plain), rel=1e-9)
