"""Amplitudes that are sizes in nature, in the probability of an explanation.

Source: derived here: a size has a prior of half a normal distribution, which is twice as dense as
a whole one above zero; the readings are then as many times more probable as twice the share of
the posterior above zero says.
"""

from __future__ import annotations

import numpy as np
from scipy.special import log_ndtr

from vmach.fit.marginal_likelihood import Posterior
from vmach.fit.terms import JointFit

__all__ = ["log_factor_of_sizes"]


def log_factor_of_sizes(fit: JointFit, posterior: Posterior) -> float:
    """Logarithm of how many times more probable the readings are as sizes are not below zero.

    Several sizes count as independent.

    Parameters
    ----------
    fit : JointFit
    posterior : Posterior
        Its effects begin with the coefficients of the fit's terms.
    """
    counts = [len(own) for own in fit.coefficients]
    places = [
        first + i
        for first, term in zip(np.cumsum([0, *counts]), fit.terms, strict=False)
        for i, parameter in enumerate(term.effect.amplitudes)
        if parameter.is_size
    ]
    if not places:
        return 0.0
    away = posterior.mean[1][places] / posterior.deviation_of_effects[places]
    return float(np.sum(np.log(2.0) + log_ndtr(away)))
