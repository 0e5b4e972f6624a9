"""The evidence of a set of effects is a ratio of probabilities, worked out here in full."""

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.stats import multivariate_normal

from tests.unit.test_diagnosis_verdicts import stretched_and_loose, tip_job
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.diagnosis.score import evidence_of_set
from vmach.diagnosis.search import prepare_search
from vmach.effects import catalogue
from vmach.fit.evidence import WIDTHS


@pytest.fixture(scope="module")
def search(tmp_path_factory):
    job = tip_job(tmp_path_factory.mktemp("job"), stretched_and_loose)
    wanted = [catalogue()[name] for name in ("scale", "backlash", "squareness")]
    return prepare_search(survey_job(job), wanted)


def explained(search, *labels):
    found = search.nothing
    for label in labels:
        known = [candidate.label for candidate in search.candidates]
        found = search.extend(found, known.index(label))
    return found


def test_evidence_is_the_ratio_of_two_normal_distributions(search):
    """Readings off the nuisance, with and without a scale of random size among their causes."""
    survey, fit = search.survey, explained(search, "scale X").fit
    free = null_space(survey.nuisance.T)
    causes = survey.factors
    noise = np.diag(survey.u_mm**2) + causes @ causes.T
    signature = fit.signatures_mm[0]

    def log_probability(covariance):
        return multivariate_normal.logpdf(
            free.T @ survey.residual_mm, cov=free.T @ covariance @ free
        )

    ratios = [
        log_probability(noise + width**2 * signature @ signature.T) - log_probability(noise)
        for width in WIDTHS
    ]
    expected = max(ratios) - np.log(len(WIDTHS))
    # the whitening leaves out what changes a variance by less than one per cent
    assert evidence_of_set(survey, search.whiten, fit) == pytest.approx(expected, rel=0.01)


def test_score_does_not_depend_on_the_way_to_a_set(search):
    one, other = ("scale X", "backlash Y"), ("backlash Y", "scale X")
    assert explained(search, *one).score == pytest.approx(explained(search, *other).score, abs=0.1)


def test_a_needless_effect_lowers_the_score(search):
    pair = explained(search, "scale X", "backlash Y")
    assert explained(search, "scale X", "backlash Y", "squareness C0Y").score < pair.score - 3.0
