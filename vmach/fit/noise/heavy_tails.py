"""Heavy tails of the noise: weights of readings as of Student's t.

Source: C. Bishop, Pattern Recognition and Machine Learning (2006), 2.3.7 and eq. 10.3.
"""

from __future__ import annotations

import numpy as np
from scipy.special import digamma, gammaln, stdtrit

from vmach.measurements import apart_from_few, apart_from_neighbours

__all__ = ["ROUNDING", "WORTH", "log_prior_of_weights", "weights_of"]

#: degrees of freedom of Student's t that are tried for heavy tails; infinite is normal
_TAILS = (3.0, 5.0, 10.0)
#: log probability that a further parameter of the noise has to bring (Bayesian information
#: criterion at a thousand readings)
WORTH = 3.5
#: readings that leave less than this of their stated uncertainty leave what arithmetic rounds
ROUNDING = 1e-9


def weights_of(left: np.ndarray, group: np.ndarray) -> tuple[np.ndarray, float, float]:
    """Weight of every reading as one of Student's t, whose tails the readings tell.

    Parameters
    ----------
    left : (n,) float64
        What is left of each reading, without its own say, in its standard uncertainty.
    group : (n,) str
        Feature or run of each: neighbours that lie together have a cause, and are no tail.

    Returns
    -------
    weight : (n,) float64
    float
        Their log probability beside the covariance.
    float
        Degrees of freedom; infinite where all weigh the same.
    """
    away = np.abs(left)
    if np.median(away) < ROUNDING:
        return np.ones(len(away)), 0.0, np.inf
    normal = -0.5 * len(away) * (1.0 + np.log(2.0 * np.pi * np.mean(away**2)))
    best, found = normal + WORTH, (np.ones(len(away)), 0.0, np.inf)
    alone = np.minimum(away, apart_from_neighbours(left, group, few=apart_from_few(left, group)))
    for degrees in _TAILS:
        scale = np.median(away) / stdtrit(degrees, 0.75)
        log = gammaln(0.5 * (degrees + 1)) - gammaln(0.5 * degrees)
        log -= 0.5 * np.log(np.pi * degrees) + np.log(scale)
        square = (away / scale) ** 2 / degrees
        total = len(away) * log - 0.5 * (degrees + 1) * np.log1p(square).sum()
        if total > best:
            best, weight = total, (degrees + 1.0) / (degrees + (alone / scale) ** 2)
            found = weight, log_prior_of_weights(weight, degrees), degrees
    return found


def log_prior_of_weights(weight: np.ndarray, degrees: float) -> float:
    """Log probability of mean weights (n,) that the covariance of the readings does not state.

    With it the readings are as probable as under Student's t, whose weights are chi-squared: each
    is known up to a gamma distribution, whose mean it is. Without it a reading that weighs little
    costs nothing.

    Source: derived here, as the variational bound of C. Bishop, Pattern Recognition and Machine
    Learning (2006), eq. 10.3; it is exact for one reading where the weight is its expected one.
    """
    before, after = 0.5 * degrees, 0.5 * (degrees + 1.0)
    rate = after / weight
    expected = digamma(after) - np.log(rate)
    relative = (after - before) * digamma(after) - gammaln(after) + gammaln(before)
    relative += before * np.log(rate / before) + after * (before - rate) / rate
    return float(np.sum(0.5 * (expected - np.log(weight)) - relative))
