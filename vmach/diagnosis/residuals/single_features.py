"""Does an effect's law say more than that a few places sit elsewhere?

An effect that shows at a handful of places only, as a height of each floor, is soon fitted by a
law with as many free numbers. So it competes with the plainest of all descriptions: every place
at which it shows has an offset of its own, whatever the cause. A law that is shown by the readings
wins, because it needs fewer numbers for the same places. A place is a feature, or the part of a
feature that the effect acts on: a step in the middle of a floor makes two of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from vmach.diagnosis.explanation import MARGIN, Explanation
from vmach.diagnosis.score import numbers_determined, price_of_looking
from vmach.diagnosis.search import Search
from vmach.fit.evidence import WIDTHS, SignatureBank
from vmach.fit.terms import JointFit

__all__ = ["AgainstOffsets", "against_offsets"]

#: an effect shows at a place where it is at least this share of what it is at the worst one
_SHOWS = 0.2
#: counts of numbers that the readings determine in part are apart by more than this
_FEWER = 0.5
#: usual size of an offset, mm
_SIZE_MM = 5e-3


@dataclass(frozen=True)
class AgainstOffsets:
    """Laws beside offsets of the places at which they show most.

    Attributes
    ----------
    gain : float
        Log evidence for the laws against the offsets.
    numbers : float
        How many numbers of the laws the readings determine.
    places : float
        How many offsets they determine of the places at which the effects show.
    is_shape_of_one : bool
        Whether it is a curve, and shows at one of several places: it may be that place's shape.
    beside_curve : bool
        Whether a curve, which may take any shape, is in the explanation.
    """

    gain: float
    numbers: float
    places: float
    is_shape_of_one: bool
    beside_curve: bool

    @property
    def is_shown(self) -> bool:
        """Whether the laws explain more than the offsets do, or as much with fewer numbers.

        Several numbers, as many as offsets, have to explain far more. Beside a curve, fewer are
        not enough.
        """
        if self.is_shape_of_one:
            return False
        if self.numbers < self.places - _FEWER and not self.beside_curve:
            return self.gain >= 0.0
        can_bend = self.numbers > max(self.places - _FEWER, 1.0 + _FEWER)
        return self.gain > (2.0 * MARGIN if can_bend else MARGIN)


def against_offsets(search: Search, explanation: Explanation, ks: Sequence[int]) -> AgainstOffsets:
    """Some terms of an explanation against offsets of the places that they show at.

    Parameters
    ----------
    search : Search
    explanation : Explanation
    ks : sequence of int
        Numbers of the terms.
    """
    assert explanation.fit is not None
    fit, others = explanation.fit, search.without(explanation, ks)
    left = search.absorber(others)
    places = _places(search.survey.group, [fit.signatures_mm[k] for k in ks])
    # what alignment and the other effects take up does not show
    shown = left(search.whiten(sum(fit.explained_mm(k) for k in ks)))
    size = np.sqrt(shown**2 @ places / places.sum(axis=0))
    columns = left(search.whiten(_SIZE_MM * places[:, np.argsort(-size)]))
    offsets = _evidence_of_the_first(columns, others.residual)
    chief = columns[:, : np.count_nonzero(size > _SHOWS * size.max())]
    # the places are chosen by looking at the fit, for which the offsets do not pay either
    looking = [price_of_looking(search.survey, fit.terms[k]) for k in ks]
    known = len(ks) * np.log(len(search.candidates)) + sum(looking)
    gain = explanation.score - others.score + known + sum(_price_of_size(fit, k) for k in ks)
    determined, curves = numbers_determined(chief), any(fit.terms[k].is_curve for k in ks)
    return AgainstOffsets(
        gain=float(gain - logsumexp(offsets) + np.log(len(offsets))),
        numbers=sum(fit.numbers(k) for k in ks),
        places=determined,
        is_shape_of_one=curves and determined < 1.0 + _FEWER < numbers_determined(columns),
        beside_curve=any(term.is_curve for term in fit.terms),
    )


def _places(group: np.ndarray, signatures_mm: Sequence[np.ndarray]) -> np.ndarray:
    """Which readings lie at each place, (n, P) of 0 and 1."""
    for signature in signatures_mm:
        acts = np.abs(signature).max(axis=1) > 0.0
        group = np.char.add(group, np.where(acts, ":1", ":0"))
    names, number = np.unique(group, return_inverse=True)
    return np.eye(len(names))[number]


def _evidence_of_the_first(columns: np.ndarray, reading: np.ndarray) -> np.ndarray:
    """Log evidence for offsets with whitened signatures (n, P): of one, of two, ... places (P,)."""
    firsts = [columns[:, None, : m + 1] for m in range(columns.shape[1])]
    bank = SignatureBank(firsts, [np.zeros(1)] * len(firsts))
    return np.array([float(e.log_factor[0]) for e in bank.evidence(reading[:, None])])


def _price_of_size(fit: JointFit, k: int) -> float:
    """What term k paid for being larger than usual, which does not count here.

    Numbers that are large and nearly cancel each other do count.
    """
    term, signatures = fit.terms[k], fit.signatures_mm[k]
    if term.is_curve:
        return 0.0
    usual = np.linalg.norm(signatures, axis=0).max()
    size = np.linalg.norm(signatures @ fit.coefficients[k]) / usual
    return 0.5 * float(size / WIDTHS[-1]) ** 2
