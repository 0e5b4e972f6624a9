"""Leaving the choice of interpolation to the data, with the evidence kept.

Source: Hastie, Tibshirani and Friedman, The Elements of Statistical Learning (2009), section
7.10: leaving out, and the rule of one standard error.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.errors import InputError
from vmach.machine.tables.interpolation import Extrapolation, Interpolation, Method

__all__ = ["CANDIDATES", "Score", "choose", "cross_validate"]

#: from few free numbers to as many as there are points
CANDIDATES = (
    *(Interpolation(Method.LEGENDRE, order) for order in (1, 2, 3, 5, 7)),
    *(Interpolation(Method.FOURIER, order) for order in (1, 2, 3)),
    Interpolation(Method.SMOOTHING),
    Interpolation(Method.LINEAR),
    Interpolation(Method.PCHIP),
    Interpolation(Method.CUBIC),
)

#: fits of one method at most
_MOST_FOLDS = 40


@dataclass(frozen=True)
class Score:
    """How well a method foretells a measured point from the others.

    Attributes
    ----------
    interpolation : Interpolation
    rms : float
        Root mean square of left-out value minus predicted, unit of the table.
    standard_error : float
        Of the mean square, turned into the unit of `rms`.
    """

    interpolation: Interpolation
    rms: float
    standard_error: float


def cross_validate(
    position: np.ndarray,
    value: np.ndarray,
    candidates: tuple[Interpolation, ...] = CANDIDATES,
) -> tuple[Score, ...]:
    """Leave out each inner point of (K,) positions and values in turn; predict it from the rest.

    Of long tables every 40th inner point is left out at once. Methods that need more points than
    there are take no part; fewer than three points tell nothing.

    Returns
    -------
    tuple of Score
        In the order of the candidates.
    """
    scores = []
    inner = np.arange(1, len(position) - 1)
    folds = [inner[k::_MOST_FOLDS] for k in range(min(len(inner), _MOST_FOLDS))]
    for candidate in candidates if folds else ():
        try:
            missed = np.concatenate([_miss(candidate, position, value, out) for out in folds])
        except InputError:
            continue
        square = missed**2
        mean = float(np.mean(square))
        spread = float(np.std(square, ddof=1)) / np.sqrt(len(square)) if len(square) > 1 else 0.0
        rms = np.sqrt(mean)
        scores.append(Score(candidate, rms, np.sqrt(mean + spread) - rms))
    return tuple(scores)


def choose(scores: tuple[Score, ...]) -> Interpolation:
    """The simplest method whose score is within one standard error of the best.

    The one-standard-error rule of Breiman et al. (1984): differences smaller than that are
    noise, and then the simpler curve is the safer one.
    """
    if not scores:
        return Interpolation(Method.LINEAR)
    best = min(scores, key=lambda score: score.rms)
    rounding = 1e-9 * max(score.rms for score in scores)
    bound = best.rms + best.standard_error + rounding
    return next(score for score in scores if score.rms <= bound).interpolation


def _miss(
    candidate: Interpolation, position: np.ndarray, value: np.ndarray, out: np.ndarray
) -> np.ndarray:
    """Left-out values minus predictions at the points `out`."""
    curve = candidate.fit(np.delete(position, out), np.delete(value, out), Extrapolation.HOLD)
    return value[out] - curve(position[out])
