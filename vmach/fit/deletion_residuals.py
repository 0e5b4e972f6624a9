"""Deletion residuals: how far each reading lies from what all others say of it.

A fit with much freedom bends towards a reading that is wrong, and hides it; the others do not.

Source: C. Rasmussen and C. Williams, Gaussian Processes for Machine Learning (2006), eq. 5.12;
R. D. Cook and S. Weisberg, Residuals and Influence in Regression (1982), section 2.2.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import solve_triangular

from vmach.fit.marginal_likelihood import Posterior

__all__ = ["deletion_residuals"]

#: share of its own precision that a reading keeps beside all others at least: below it the fit
#: goes through the reading whatever that says
_LEAST = 1e-6
#: readings whose residuals are worked out together
_AT_ONCE = 2000
#: columns of members that are worked out together
_COLUMNS = 50


def deletion_residuals(posterior: Posterior) -> np.ndarray:
    """Residual of every reading beside all others, in its standard deviations, (n,).

    As if it weighed as much as any other: one that weighs little is not hidden by that.
    """
    base, factor = posterior.base, posterior.sizes.factor
    noise = base.noise

    def back(white: np.ndarray) -> np.ndarray:
        return noise.shown_mm[:, None] * noise.back(white)

    precision = noise.precisions - _squares(back(base.free))
    members, effects, root = posterior.members, posterior.effects.columns.white, posterior.root
    taken = np.empty((len(precision), len(root)))
    for k in range(0, len(members.here), _COLUMNS):
        some = slice(k, k + _COLUMNS)
        own = back(base.z[:, members.here[some]] * members.scale[some])
        taken[:, k : k + own.shape[1]] = own
    taken[:, len(members.here) :] = back(effects / factor)
    for k in range(0, len(taken), _AT_ONCE):
        some = slice(k, k + _AT_ONCE)
        precision[some] -= _squares(solve_triangular(root, taken[some].T, lower=True).T)
    precision = np.maximum(precision, _LEAST * noise.precisions)
    away = back(posterior.left[:, None])[:, 0] / precision
    own = (1.0 - noise.share) * (1.0 - 1.0 / noise.weight)
    return away / np.sqrt(1.0 / precision + own)


def _squares(rows: np.ndarray) -> np.ndarray:
    return np.einsum("nk,nk->n", rows, rows)
