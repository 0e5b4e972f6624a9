"""Does an effect's law say more than that a few places sit elsewhere?

An effect that shows at a handful of places only, as a height of each floor, is soon fitted by a
law with as many free numbers. So it competes with the plainest of all descriptions: every place
at which it shows has an offset of its own, whatever the cause. A law that is shown by the readings
wins, because it needs fewer numbers for the same places. A place is a feature, or the part of a
feature that the effect acts on: a step in the middle of a floor makes two of it.
"""

from __future__ import annotations

import numpy as np
from scipy.special import logsumexp

from vmach.diagnosis.explanation import Explanation
from vmach.diagnosis.search import Search
from vmach.fit.evidence import WIDTHS, SignatureBank
from vmach.fit.joint_fit import JointFit

__all__ = ["gain_over_offsets"]

#: usual size of an offset, mm
_SIZE_MM = 5e-3


def gain_over_offsets(search: Search, explanation: Explanation, k: int) -> float:
    """Log evidence for term k of an explanation against offsets of the places it shows at.

    Parameters
    ----------
    search : Search
    explanation : Explanation
    k : int

    Returns
    -------
    float
        Negative where the offsets explain the readings better: the law is not shown.
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
    own = search.candidates.index(search.candidate(explanation.fit.terms[k].label))
    grown = search.extend(others, own)
    assert grown.fit is not None
    return grown.score - others.score + _price_of_size(grown.fit) - offsets


def _evidence_of_the_first(columns: np.ndarray, reading: np.ndarray) -> float:
    """Log evidence for offsets with whitened signatures (n, P): the first, or two, or three ..."""
    count = np.arange(1, columns.shape[1] + 1)
    bank = SignatureBank([columns[:, None, :m] for m in count], [np.zeros(1)] * len(count))
    found = [float(e.log_factor[0]) for e in bank.evidence(reading[:, None])]
    return float(logsumexp(found)) - np.log(len(count))


def _places(group: np.ndarray, signatures_mm: np.ndarray) -> np.ndarray:
    """Which readings lie at each place, (n, P) of 0 and 1."""
    acts = np.abs(signatures_mm).max(axis=1) > 0.0
    names, number = np.unique(np.char.add(group, np.where(acts, ":1", ":0")), return_inverse=True)
    return np.eye(len(names))[number]


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
