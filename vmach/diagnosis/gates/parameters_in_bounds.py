"""Parameters that nature bounds, in the probability of an explanation.

Source: derived here: a prior that is cut off at bounds is denser between them; the readings are
then as many times more probable as the posterior has a larger share between them than the prior.
Beyond a bound a tangent would go on with a law that ends there.
"""

from __future__ import annotations

import numpy as np
from scipy.special import log_ndtr

from vmach.fit.marginal_likelihood import Posterior
from vmach.fit.terms import JointFit

__all__ = ["log_factor_of_bounds"]

#: ends of a parameter without bounds
_NONE = (-np.inf, np.inf)


def log_factor_of_bounds(fit: JointFit, posterior: Posterior) -> float:
    """Logarithm of how many times more probable the readings are as parameters have bounds.

    Sizes lie above zero, inner parameters where the catalogue has them. Each counts by itself.

    Parameters
    ----------
    fit : JointFit
    posterior : Posterior
        Its effects begin with the coefficients of the fit's terms, and all their tangents.
    """
    ends = []
    for term, own in zip(fit.terms, fit.coefficients, strict=True):
        sizes = [(0.0, np.inf) if p.is_size else _NONE for p in term.effect.amplitudes]
        # a curve has more coefficients than amplitudes, a drift of one axis fewer
        ends += (sizes + [_NONE] * len(own))[: len(own)]
    before = list(ends)
    for term in fit.terms:
        for p in term.free_parameters:
            bounds = np.log([p.low, p.high])
            ends.append((bounds - np.log(term.inner[p.name])) / p.spread)
            before.append((bounds - np.log(p.usual)) / p.spread)
    mean, deviation = posterior.mean[1][: len(ends)], posterior.deviation_of_effects[: len(ends)]
    after = (np.array(ends) - mean[:, None]) / deviation[:, None]
    return float(np.sum(_log_share(after) - _log_share(np.array(before))))


def _log_share(ends: np.ndarray) -> np.ndarray:
    """Logarithm of the share of a standard normal distribution between two ends each, (m, 2)."""
    low, high = np.where(ends[:, :1] > 0.0, -ends[:, ::-1], ends).T
    upper = log_ndtr(high)
    return upper + np.log(-np.expm1(log_ndtr(low) - upper))
