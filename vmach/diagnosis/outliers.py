"""Readings that no cause explains, because their neighbours know nothing of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import ndtri

from vmach.diagnosis.explanation import Explanation
from vmach.diagnosis.search import Search
from vmach.fit.survey import Survey
from vmach.measurements import apart_from_neighbours

__all__ = ["outlier_note", "outliers", "reading_names"]

#: at most this share of the readings may be left out as outliers after the fit
_MOST_OUTLIERS = 0.05
#: how far out of the worst one a reading has to be to be left out with it
_AMONG_WORST = 0.3


def outliers(search: Search, explanation: Explanation) -> np.ndarray:
    """Readings that a normal distribution would not hold, (n,) bool; none if there are many.

    Where neighbours agree with each other there is a cause, and no chip under the probe. Only the
    worst are given: they bend what is fitted, so that good readings seem to stand out as well.
    """
    count = len(search.survey)
    limit = -ndtri(0.5 * 0.001 / count)
    away = np.abs(explanation.residual)
    alone = apart_from_neighbours(explanation.residual, search.survey.group) > limit
    astray = (away > limit) & alone
    if not astray.any() or astray.sum() > _MOST_OUTLIERS * count:
        return np.zeros(count, dtype=bool)
    return astray & (away > _AMONG_WORST * away[astray].max())


def outlier_note(names: Sequence[str], count: int) -> str:
    """What is said of the readings, of `count`, that were left out."""
    shown = ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
    return f"left out, as they are out of all proportion ({len(names)} of {count}): {shown}"


def reading_names(survey: Survey, rows: np.ndarray) -> list[str]:
    """File and name of the readings in (n,) bool."""
    return [_reading_name(survey, k) for k in np.flatnonzero(rows)]


def _reading_name(survey: Survey, k: int) -> str:
    for m in survey.measurements:
        if k < len(m):
            return f"{m.name} {m.id[k]}"
        k -= len(m)
    raise IndexError(k)
