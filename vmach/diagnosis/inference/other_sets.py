"""Parameters beside other effects: what an explanation's own would be in sets that are possible.

The interval of a parameter is too narrow where it counts one set of effects alone: another that
the readings do not exclude may share its work.

Source: J. Hoeting, D. Madigan, A. Raftery and C. Volinsky, Bayesian Model Averaging: A Tutorial,
Statist. Sci. 14 (1999) 382, eqs. 1 and 2; closed form derived here: means and covariances of
normal variables along tangents, at the sizes that were found.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.fit.evidence import WIDTHS
from vmach.fit.marginal_likelihood import Effects, Posterior
from vmach.fit.uncertainty import Otherwise

__all__ = ["otherwise"]

#: sets that are less probable, relative to the one found, move no end of an interval: a fifth of
#: the 2.5 % that lie beyond it
_LEAST = 0.005


@dataclass(frozen=True)
class _OtherSet:
    """One effect more, or in the place of a term.

    Attributes
    ----------
    weight : float
        How probable it is, relative to the set that was found; at most as probable.
    added : (int, int, int)
        The candidate, the place of its inner parameters, and the prior width of its amplitudes.
    instead_of : int or None
        The term that it takes the place of.
    """

    weight: float
    added: tuple[int, int, int]
    instead_of: int | None


def otherwise(weighing: Weighing, found: Explanation) -> Sequence[Sequence[Otherwise]]:
    """Of each term of an explanation what it is in other sets that hold it."""
    fit = found.fit
    if fit is None:
        return ()
    sets = list(_other_sets(weighing, found))
    if not sets:
        return [()] * len(fit.terms)
    gram, seen, place_of = _products(weighing, found, [other.added for other in sets])
    places, wide = _places_of_terms(found), weighing.prior_widths(fit)
    every = np.arange(len(found.posterior.effects))
    mean, covariance = _normal(gram, seen, every)
    lists: list[list[Otherwise]] = [[] for _ in fit.terms]
    for other in sets:
        gone = places[other.instead_of] if other.instead_of is not None else []
        kept = np.setdiff1d(every, gone)
        there = np.append(kept, place_of[other.added])
        mean_there, covariance_there = _normal(gram, seen, there)
        for k, here in enumerate(places):
            if k != other.instead_of:
                at, scale = np.searchsorted(kept, here), wide[here]
                more = covariance_there[np.ix_(at, at)] - covariance[np.ix_(here, here)]
                moved = scale * (mean_there[at] - mean[here])
                lists[k].append(Otherwise(other.weight, moved, more * np.outer(scale, scale)))
    return lists


def _products(
    weighing: Weighing, found: Explanation, asked: Sequence[tuple[int, int, int]]
) -> tuple[np.ndarray, np.ndarray, dict[tuple[int, int, int], np.ndarray]]:
    """Of all columns with each other and with the readings, and where those of an effect stand.

    First an explanation's own, then those of other effects; many sets ask for the same.
    """
    added = {
        one: WIDTHS[one[2]] * weighing.candidates[one[0]].signatures_mm[:, one[1]]
        for one in dict.fromkeys(asked)
    }
    own, nothing = found.posterior.effects.columns, Effects(weighing.base.no_columns)
    others = weighing.base.columns(np.hstack([*added.values()]))
    beside = Posterior(weighing.base, found.posterior.sizes, nothing)
    ends = (len(own) + np.cumsum([0, *(c.shape[1] for c in added.values())])).tolist()
    places = map(np.arange, ends, ends[1:])
    return *beside.products(own.beside(others)), dict(zip(added, places, strict=True))


def _other_sets(weighing: Weighing, found: Explanation) -> Iterator[_OtherSet]:
    """Sets with one effect more, and with another in the place of one, that are possible."""
    own = [weighing.index_of(term.label) for term in found.terms]
    views = [(None, found, 0.0)]
    for k, i in enumerate(own):
        others = weighing.without(found, [k], resize=False)
        views.append((k, others, float(weighing.gains(others)[i])))
    for instead_of, view, least in views:
        odds, evidence = weighing.gains(view) - least, weighing.evidence(view)
        for i in np.flatnonzero(odds > np.log(_LEAST)):
            if i not in own:
                added = int(i), int(evidence.best[i, 0]), int(evidence.best_width[i, 0])
                yield _OtherSet(float(np.exp(min(odds[i], 0.0))), added, instead_of)


def _places_of_terms(found: Explanation) -> list[np.ndarray]:
    """Where the amplitudes and inner parameters of each term stand among its columns."""
    assert found.fit is not None
    amplitudes = np.cumsum([0, *map(len, found.fit.coefficients)])
    counts = [len(term.free_parameters) for term in found.fit.terms]
    inner = amplitudes[-1] + np.cumsum([0, *counts])
    return [
        np.concatenate([np.arange(*amplitudes[k : k + 2]), np.arange(*inner[k : k + 2])])
        for k in range(len(counts))
    ]


def _normal(gram: np.ndarray, seen: np.ndarray, there: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Mean (e,) and covariance (e, e) of the columns that are there, in prior deviations."""
    covariance = np.linalg.inv(gram[np.ix_(there, there)] + np.eye(len(there)))
    return covariance @ seen[there], covariance
