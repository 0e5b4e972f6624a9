"""What a form foretells of features that were not fitted."""

from __future__ import annotations

import numpy as np

from vmach.base.units import um_from_mm
from vmach.fit.survey import Survey
from vmach.fit.terms import JointFit

__all__ = ["held_out_um"]

_FOLDS = 5


def held_out_um(survey: Survey, fit: JointFit, last: int) -> tuple[float, float]:
    """Root mean square of held-out features, without and with term `last` of a fit, um.

    Every fifth feature or stretch of a test in turn; alignment and zeros on all readings. Amounts
    have the prior that they have in the fit: others may tell nothing of one of them.
    """
    groups, number = np.unique(survey.blocks, return_inverse=True)
    fold = np.random.default_rng(0).permutation(len(groups))[number] % _FOLDS
    others = [fit.explained_mm(k) for k in range(len(fit.terms)) if k != last]
    target = survey.residual_mm - sum(others, np.zeros(len(survey)))
    target = target - survey.aligned(target[:, None])[:, 0]
    column = fit.signatures[last].mm
    column = column - survey.aligned(column)
    left = target.copy()
    prior = np.eye(column.shape[1]) / fit.terms[last].prior_width
    for k in range(_FOLDS):
        train, test = fold != k, fold == k
        weight = 1.0 / survey.u_mm[train]
        known = np.vstack([column[train] * weight[:, None], prior])
        aim = np.concatenate([target[train] * weight, np.zeros(len(prior))])
        amount = np.linalg.lstsq(known, aim)[0]
        left[test] = target[test] - column[test] @ amount
    without, with_it = (float(um_from_mm(np.sqrt(np.mean(v**2)))) for v in (target, left))
    return without, with_it
