"""Held-out groups: does an effect, fitted on some features, predict the others better?"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vmach.fit.survey import Survey
from vmach.fit.terms import JointFit

__all__ = ["holds_out"]

_FOLDS = 5
#: prior width of amplitudes, in usual sizes: what the rest does not tell is small
_WIDTH = 3.0


def holds_out(survey: Survey, fit: JointFit) -> list[bool]:
    """For every term: whether the held-out groups are predicted better with it than without.

    Whole features and runs, or stretches of a drift or tip test, are held out, every fifth in
    turn; the amplitudes are fitted on the rest, alignment and zeros on all readings.
    """
    groups, number = np.unique(_blocks(survey), return_inverse=True)
    if len(groups) < _FOLDS:
        return [True] * len(fit.terms)

    def misfit(terms: Sequence[int]) -> float:
        """Summed over the groups; the logarithm keeps one that stands alone from deciding."""
        squares = np.bincount(number, _held_out_squares(survey, fit, terms, number))
        count = np.bincount(number)
        return float(np.sum(count * np.log1p(squares / count)))

    everything = range(len(fit.terms))
    whole = misfit(everything)
    return [whole < misfit([i for i in everything if i != k]) for k in everything]


def _blocks(survey: Survey) -> np.ndarray:
    """What is held out together, (n,) str: blocks of every instrument by itself."""
    return np.concatenate(
        [
            np.char.add(f"{k}:", m.instrument.blocks(m).astype(str))
            for k, m in enumerate(survey.measurements)
        ]
    )


def _held_out_squares(
    survey: Survey, fit: JointFit, terms: Sequence[int], number: np.ndarray
) -> np.ndarray:
    """Weighted square of every reading, (n,), foretold from the groups of the other folds."""
    fold = np.random.default_rng(0).permutation(number.max() + 1)[number] % _FOLDS
    weight = 1.0 / survey.u_mm[:, None]
    basis, _ = np.linalg.qr(survey.nuisance * weight)
    columns = [fit.signatures_mm[k] for k in terms]
    widths = [np.full(fit.signatures_mm[k].shape[1], fit.terms[k].width or _WIDTH) for k in terms]
    design = np.hstack([np.zeros((len(survey), 0)), *columns]) * weight
    target = survey.residual_mm * weight[:, 0]
    design = design - basis @ (basis.T @ design)
    target = target - basis @ (basis.T @ target)
    prior = np.diag(1.0 / np.concatenate([np.zeros(0), *widths]))
    squares = np.empty(len(survey))
    for k in range(_FOLDS):
        train, test = fold != k, fold == k
        rows = np.vstack([design[train], prior])
        aim = np.concatenate([target[train], np.zeros(len(prior))])
        solution = np.linalg.lstsq(rows, aim, rcond=None)[0] if len(prior) else np.zeros(0)
        squares[test] = (target[test] - design[test] @ solution) ** 2
    return squares
