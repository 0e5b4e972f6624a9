"""Readings that no cause explains, because their neighbours know nothing of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import ndtri

from vmach.fit.survey import Survey
from vmach.measurements import apart_from_neighbours

__all__ = ["MOST_OUTLIERS", "outlier_note", "outliers", "reading_names", "worst_of"]

#: at most this share of the readings may be left out as outliers after the fit
MOST_OUTLIERS = 0.05
#: readings this share of the worst one away are among the worst; of three readings at one place
#: of which one is bad, the good ones stand out half as far
_AMONG_WORST = 0.6


def outliers(survey: Survey, residual: np.ndarray) -> np.ndarray:
    """Readings that a normal distribution would not hold, (n,) bool.

    Where neighbours agree with each other there is a cause, and no chip under the probe.

    Parameters
    ----------
    survey : Survey
    residual : (n,) float64
        What an explanation leaves of its readings, whitened.
    """
    limit = -ndtri(0.5 * 0.001 / len(survey))
    alone = apart_from_neighbours(residual, survey.group) > limit
    return (np.abs(residual) > limit) & alone


def worst_of(astray: np.ndarray, residual: np.ndarray) -> np.ndarray:
    """Of some readings, (n,) bool, those that stand out most.

    They bend what is fitted, so that good ones seem to stand out with them.
    """
    away = np.abs(residual)
    return astray & (away > _AMONG_WORST * away[astray].max())


def outlier_note(names: Sequence[str], count: int) -> str:
    """What is said of the readings, of `count`, that were left out."""
    shown = ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
    return f"left out, as they are out of all proportion ({len(names)} of {count}): {shown}"


def reading_names(survey: Survey, rows: np.ndarray) -> list[str]:
    """File and name of the readings in (n,) bool."""
    names = [f"{m.name} {own}" for m in survey.measurements for own in m.id]
    return [names[k] for k in np.flatnonzero(rows)]
