"""Held-out groups: does an effect, fitted on some features, predict the others better?"""

from __future__ import annotations

import numpy as np

from vmach.fit.joint_fit import JointFit
from vmach.fit.survey import Survey

__all__ = ["holds_out"]

_FOLDS = 5
#: prior width of amplitudes, in usual sizes: what the rest does not tell is small
_WIDTH = 3.0


def holds_out(survey: Survey, fit: JointFit) -> list[bool]:
    """For every term: whether the held-out groups are predicted better with it than without.

    Whole groups (features, runs) are held out, every fifth in turn; the amplitudes are fitted on
    the rest, alignment and zeros on all readings.
    """
    groups, number = np.unique(survey.group, return_inverse=True)
    if len(groups) < _FOLDS:
        return [True] * len(fit.terms)
    order = np.random.default_rng(0).permutation(len(groups))
    fold = order[number] % _FOLDS
    everything = _score(survey, fit, range(len(fit.terms)), fold)
    return [
        everything < _score(survey, fit, [i for i in range(len(fit.terms)) if i != k], fold)
        for k in range(len(fit.terms))
    ]


def _score(survey: Survey, fit: JointFit, terms, fold: np.ndarray) -> float:
    """Weighted sum of squares of the held-out readings, all folds together."""
    weight = 1.0 / survey.u_mm[:, None]
    basis, _ = np.linalg.qr(survey.nuisance * weight)
    columns = [fit.signatures_mm[k] for k in terms]
    widths = [np.full(fit.signatures_mm[k].shape[1], fit.terms[k].width or _WIDTH) for k in terms]
    design = np.hstack([np.zeros((len(survey), 0)), *columns]) * weight
    target = survey.residual_mm * weight[:, 0]
    design = design - basis @ (basis.T @ design)
    target = target - basis @ (basis.T @ target)
    prior = np.diag(1.0 / np.concatenate([np.zeros(0), *widths]))
    total = 0.0
    for k in range(_FOLDS):
        train, test = fold != k, fold == k
        rows = np.vstack([design[train], prior])
        aim = np.concatenate([target[train], np.zeros(len(prior))])
        solution = np.linalg.lstsq(rows, aim, rcond=None)[0] if len(prior) else np.zeros(0)
        total += float(np.sum((target[test] - design[test] @ solution) ** 2))
    return total
