"""Does an effect's law say more than that a few places sit elsewhere?

An effect that shows at a handful of places only, as a height of each floor, is soon fitted by a
law with as many free numbers. So it competes with the plainest of all descriptions: every place
at which it shows has an offset of its own, whatever the cause. A law that is shown by the readings
wins, because it needs fewer numbers for the same places. A place is a feature, or the part of a
feature that the effect acts on: a step in the middle of a floor makes two of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from vmach.diagnosis.explanation import MARGIN, Explanation
from vmach.diagnosis.search import Search
from vmach.fit.evidence import WIDTHS, SignatureBank
from vmach.fit.terms import FREE, JointFit

__all__ = ["AgainstOffsets", "against_offsets", "laws_not_shown"]

#: an effect shows at a place where it is at least this share of what it is at the worst one
_SHOWS = 0.2
#: counts of numbers that the readings determine in part are apart by more than this
_FEWER = 0.5
#: usual size of an offset, mm
_SIZE_MM = 5e-3


@dataclass(frozen=True)
class AgainstOffsets:
    """An effect's law beside offsets of the places at which it shows most.

    Attributes
    ----------
    gain : float
        Log evidence for the law against the offsets.
    numbers : float
        How many numbers of the law the readings determine.
    places : float
        How many offsets they determine of the places at which the effect shows.
    """

    gain: float
    numbers: float
    places: float

    @property
    def is_shown(self) -> bool:
        """Whether the law explains more than the offsets do, or as much with fewer numbers."""
        return self.gain > MARGIN or (self.gain >= 0.0 and self.numbers < self.places - _FEWER)


def laws_not_shown(search: Search, explanation: Explanation) -> tuple[dict[str, float], list[str]]:
    """Effects whose law says no more than offsets of the places it shows at: why, and in words."""
    left, notes = {}, []
    for k, term in enumerate(explanation.fit.terms if explanation.fit else ()):
        found = against_offsets(search, explanation, k)
        if found.is_shown:
            continue
        if found.gain < 0.0:
            left["offsets of single features"] = -found.gain
        else:
            left["as many numbers as places"] = found.numbers
        notes.append(
            f"{term.label} would fit, with {found.numbers:.0f} numbers for {found.places:.0f} "
            "independent offsets where it shows: these readings do not show its law"
        )
    return left, notes


def against_offsets(search: Search, explanation: Explanation, k: int) -> AgainstOffsets:
    """Term k of an explanation against offsets of the places that it shows at.

    Parameters
    ----------
    search : Search
    explanation : Explanation
    k : int
    """
    assert explanation.fit is not None
    others = search.without(explanation, k)
    left = search.absorber(others)
    places = _places(search.survey.group, explanation.fit.signatures_mm[k])
    # what alignment and the other effects take up does not show
    shown = left(search.whiten(explanation.fit.explained_mm(k)))
    size = np.sqrt(shown**2 @ places / places.sum(axis=0))
    columns = left(search.whiten(_SIZE_MM * places[:, np.argsort(-size)]))
    offsets = _evidence_of_the_first(columns, others.residual)
    chief = columns[:, : np.count_nonzero(size > _SHOWS * size.max())]
    own = search.candidates.index(search.candidate(explanation.fit.terms[k].label))
    grown = search.extend(others, own)
    assert grown.fit is not None
    gain = grown.score - others.score + _price_of_size(grown.fit)
    return AgainstOffsets(
        gain=gain - float(logsumexp(offsets)) + np.log(len(offsets)),
        numbers=_numbers(explanation.fit, k),
        places=_determined(chief),
    )


def _places(group: np.ndarray, signatures_mm: np.ndarray) -> np.ndarray:
    """Which readings lie at each place, (n, P) of 0 and 1."""
    acts = np.abs(signatures_mm).max(axis=1) > 0.0
    names, number = np.unique(np.char.add(group, np.where(acts, ":1", ":0")), return_inverse=True)
    return np.eye(len(names))[number]


def _evidence_of_the_first(columns: np.ndarray, reading: np.ndarray) -> np.ndarray:
    """Log evidence for offsets with whitened signatures (n, P): of one, of two, ... places (P,)."""
    firsts = [columns[:, None, : m + 1] for m in range(columns.shape[1])]
    bank = SignatureBank(firsts, [np.zeros(1)] * len(firsts))
    return np.array([float(e.log_factor[0]) for e in bank.evidence(reading[:, None])])


def _price_of_size(fit: JointFit) -> float:
    """What the last term paid for being larger than usual, which does not count here.

    Numbers that are large and nearly cancel each other do count.
    """
    term, signatures = fit.terms[-1], fit.signatures_mm[-1]
    if term.width:
        return 0.0
    usual = np.linalg.norm(signatures, axis=0).max()
    size = np.linalg.norm(signatures @ fit.coefficients[-1]) / usual
    return 0.5 * float(size / WIDTHS[-1]) ** 2


def _numbers(fit: JointFit, k: int) -> float:
    """Amplitudes and inner parameters of term k, each as far as the readings determine it."""
    term = fit.terms[k]
    spread = {p.name: p.spread for p in term.effect.inner_parameters}
    amplitudes = np.full(len(fit.coefficients[k]), term.width or FREE)
    before = np.concatenate([amplitudes, [spread[name] for name in term.free_inner]])
    return float(np.sum(1.0 - np.diag(fit.covariance[k]) / before**2))


def _determined(columns: np.ndarray) -> float:
    """How many causes of unit variance with whitened signatures (n, P) the readings determine."""
    squared = np.linalg.svd(columns, compute_uv=False) ** 2
    return float(np.sum(squared / (1.0 + squared)))
