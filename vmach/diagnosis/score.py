"""How well a set of fitted effects explains the readings: the evidence of all together.

The readings' own probability with every coefficient and inner parameter integrated over its
prior, the laws' inner parameters along their tangents (Laplace's approximation), against that
under noise alone. It depends on the fit only, not on the way by which a search came there.
"""

from __future__ import annotations

import numpy as np

from vmach.diagnosis.gates.absorbing import slack_of
from vmach.fit.evidence import WIDTHS, evidence_of_unit
from vmach.fit.survey import Survey
from vmach.fit.terms import JointFit, Term
from vmach.fit.whitening import Whitening

__all__ = ["evidence_of_set", "numbers_determined", "price_of_looking"]


def evidence_of_set(survey: Survey, whiten: Whitening, fit: JointFit) -> float:
    """Log evidence of the terms of a fit, what their laws leave open included.

    Parameters
    ----------
    survey : Survey
    whiten : Whitening
        Of the survey.
    fit : JointFit
    """
    columns = [slack_of(survey, fit)]
    for k, term in enumerate(fit.terms):
        width = term.width or _width_of(fit.coefficients[k])
        columns += [width * fit.signatures_mm[k], fit.tangents_mm[k] * term.spread_of_inner]
    prior = sum(_log_prior(survey, term) for term in fit.terms)
    return prior + evidence_of_unit(whiten(np.hstack(columns)), whiten(survey.residual_mm))


def _width_of(coefficients: np.ndarray) -> float:
    """The prior width under which fitted coefficients (K,) are most likely."""
    size = float(coefficients @ coefficients)
    likely = [-0.5 * size / w**2 - len(coefficients) * np.log(w) for w in WIDTHS]
    return WIDTHS[int(np.argmax(likely))]


def _log_prior(survey: Survey, term: Term) -> float:
    """Of a term's width, and of its inner parameters where they were found."""
    usual = -0.5 * float(np.sum(term.unusual**2))
    return usual - price_of_looking(survey, term) - np.log(len(WIDTHS))


def price_of_looking(survey: Survey, term: Term) -> float:
    """What a term pays for having been looked for at every place of a grid: its logarithm.

    Terms whose inner parameters move smoothly pay by how well these are determined.
    """
    grid = [] if term.free_inner else survey.inner_grid(term.effect, term.target)
    return float(np.log(max(len(grid), 1)))


def numbers_determined(columns: np.ndarray) -> float:
    """How many causes of unit variance with whitened signatures (n, P) the readings determine."""
    squared = np.maximum(np.linalg.eigvalsh(columns.T @ columns), 0.0)
    return float(np.sum(squared / (1.0 + squared)))
