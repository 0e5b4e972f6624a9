"""Does an effect's law say more than that a few features sit elsewhere?

An effect that shows on a handful of features only, as a height of each floor, is soon fitted by a
law with as many free numbers. So it competes with the plainest of all descriptions: every feature
on which it shows has an offset of its own, whatever the cause. A law that is shown by the readings
wins, because it needs fewer numbers for the same features.
"""

from __future__ import annotations

import numpy as np

from vmach.diagnosis.explanation import Explanation
from vmach.diagnosis.search import Search
from vmach.fit.evidence import WIDTHS, SignatureBank

__all__ = ["gain_over_offsets"]

#: a feature counts where the effect is at least this share of what it is on the worst one
_SHOWS = 0.2
#: usual size of an offset, mm
_SIZE_MM = 5e-3


def gain_over_offsets(search: Search, explanation: Explanation, k: int) -> float:
    """Log evidence for term k of an explanation against offsets of the features it shows on.

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
    names, number = np.unique(search.survey.group, return_inverse=True)
    moved = explanation.fit.explained_mm(k)
    size = np.sqrt(np.bincount(number, moved**2) / np.bincount(number))
    inside = np.eye(len(names))[number][:, size > _SHOWS * size.max()]
    others = search.without(explanation, k)
    left = search.absorber(others)
    columns = left(search.whiten(_SIZE_MM * inside))[:, None, :]
    bank = SignatureBank([columns], [np.zeros(1)])
    offsets = float(bank.evidence(others.residual[:, None])[0].log_factor[0])
    own = search.candidates.index(search.candidate(explanation.fit.terms[k].label))
    grown = search.extend(others, own)
    assert grown.fit is not None
    # that an effect is larger than usual does not count here
    size = 0.0 if grown.fit.terms[-1].width else grown.fit.coefficients[-1] / WIDTHS[-1]
    return grown.score - others.score + 0.5 * float(np.sum(np.square(size))) - offsets
