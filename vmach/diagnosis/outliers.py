"""Readings that no cause explains, because their neighbours know nothing of it."""

from __future__ import annotations

import numpy as np
from scipy.special import ndtri

from vmach.diagnosis.explanation import Explanation
from vmach.diagnosis.search import Search
from vmach.fit.survey import Survey
from vmach.measurements import apart_from_neighbours

__all__ = ["outlier_notes", "outliers"]

#: at most this share of the readings may be left out as outliers after the fit
_MOST_OUTLIERS = 0.05


def outliers(search: Search, explanation: Explanation) -> np.ndarray:
    """Readings that a normal distribution would not hold, (n,) bool; none if there are many.

    Where neighbours agree with each other there is a cause, and no chip under the probe.
    """
    count = len(search.survey)
    limit = -ndtri(0.5 * 0.001 / count)
    astray = np.abs(explanation.residual) > limit
    alone = apart_from_neighbours(explanation.residual, search.survey.group) > limit
    astray &= alone
    return astray if astray.sum() <= _MOST_OUTLIERS * count else np.zeros(count, dtype=bool)


def outlier_notes(survey: Survey, rows: np.ndarray) -> tuple[str, ...]:
    """What is said of the readings, (n,) bool, that were left out."""
    names = [_reading_name(survey, k) for k in np.flatnonzero(rows)]
    if not names:
        return ()
    shown = ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
    return (f"{len(names)} readings are out of all proportion and were left out: {shown}",)


def _reading_name(survey: Survey, k: int) -> str:
    for m in survey.measurements:
        if k < len(m):
            return f"{m.name} {m.id[k]}"
        k -= len(m)
    raise IndexError(k)
