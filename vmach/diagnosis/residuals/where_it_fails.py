"""Where the model fails: does the residual depend on feature, position, direction, feed ...?

For each covariate the readings are sorted into classes, and the sum of squares that the classes'
means explain is compared with what the readings' own covariance makes of it: under it the sum
follows a chi-squared distribution, alignment and tables' uncertainty included.

Source: E. Wilson and M. Hilferty, The distribution of chi-square, Proc. Natl. Acad. Sci. 17 (1931)
684: the cube root of chi-squared in its degrees is nearly normal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc

from vmach.base.units import um_from_mm
from vmach.diagnosis.residuals.covariates import Covariate, covariates
from vmach.fit.survey import Survey
from vmach.fit.whitening import Whiten, orthonormal

__all__ = ["Chance", "Failure", "chance_of", "where_it_fails"]

_SIGNIFICANT = 0.01


@dataclass(frozen=True)
class Chance:
    """How often noise alone makes the means of classes differ as much.

    Attributes
    ----------
    p : float
        As a probability; zero where it is below what a number holds.
    deviate : float
        The same as standard deviations of a normal variable, so that all of them have an order.
    """

    p: float
    deviate: float


@dataclass(frozen=True)
class Failure:
    """Dependence of the residual on one covariate.

    Attributes
    ----------
    by : str
        The covariate.
    p : float
        Chance that noise alone looks like this.
    text : str
        In words: the class of readings that is worst.
    """

    by: str
    p: float
    text: str


def where_it_fails(survey: Survey, whiten: Whiten, residual_mm: np.ndarray) -> tuple[Failure, ...]:
    """Dependences that noise does not explain, the clearest first.

    Parameters
    ----------
    survey : Survey
    whiten : callable
        Turns readings of the survey into plain unit noise, without what is free.
    residual_mm : (n,) float64
        Measured minus predicted.
    """
    white = whiten(residual_mm)
    aligned = residual_mm - survey.aligned(residual_mm[:, None])[:, 0]
    found = []
    for covariate in covariates(survey):
        chance = chance_of(white, whiten(covariate.is_in))
        if chance is not None and chance.p < _SIGNIFICANT:
            failure = Failure(covariate.by, chance.p, _worst_class(covariate, aligned))
            found.append((chance.deviate, failure))
    return tuple(failure for _, failure in sorted(found, key=lambda pair: -pair[0]))


def chance_of(white: np.ndarray, classes: np.ndarray) -> Chance | None:
    """How often noise alone makes the means of classes differ as much as here.

    Parameters
    ----------
    white : (n,) float64
        Readings in unit noise, without what is free.
    classes : (n, c) float64
        Which reading belongs to which class, treated likewise.

    Returns
    -------
    Chance or None
        None where what is free takes up all differences between the classes.
    """
    basis = orthonormal(classes, tolerance=1e-6)
    degrees, squares = basis.shape[1], float(np.sum((basis.T @ white) ** 2))
    if degrees == 0:
        return None
    spread = 2.0 / (9.0 * degrees)
    deviate = (np.cbrt(squares / degrees) - 1.0 + spread) / np.sqrt(spread)
    return Chance(float(chdtrc(degrees, squares)), float(deviate))


def _worst_class(covariate: Covariate, aligned_mm: np.ndarray) -> str:
    means, counts = covariate.means(aligned_mm), covariate.counts
    worst = int(np.argmax(np.abs(means) * np.sqrt(counts)))
    return (
        f"{covariate.words[worst]}: {um_from_mm(means[worst]):+.1f} um on average "
        f"({counts[worst]} readings)"
    )
