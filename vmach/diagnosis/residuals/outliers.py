"""Readings that no cause explains, because their neighbours know nothing of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.special import ndtri

from vmach.diagnosis.explanation import Explanation
from vmach.diagnosis.gates.absorbing import absorbing
from vmach.diagnosis.search import Search
from vmach.fit.joint_fit import fit_terms
from vmach.fit.survey import Survey
from vmach.fit.terms import Term
from vmach.measurements import apart_from_neighbours

__all__ = ["without_outliers", "without_suspects"]

#: at most this share of the readings may be left out as outliers after the fit
_MOST = 0.05
#: times that readings are left out; all but the last time the worst ones alone
_PASSES = 4
#: readings this share of the worst one away are among the worst; of three readings at one place
#: of which one is bad, the good ones stand out half as far
_AMONG_WORST = 0.6
#: and so many of them where leaving them out makes all else plain
_MOST_SUSPECTS = 0.01


def without_outliers(search: Search) -> tuple[Search, Explanation, tuple[str, ...]]:
    """The search without readings that no cause explains, what it finds, and a note on them.

    Where they would be many, none is left out: something is behind them.
    """
    whole, found = search.survey, search.run()
    survey, residual = whole, found.residual
    names: list[str] = []
    kept = np.ones(len(whole), dtype=bool)
    for left in reversed(range(_PASSES)):
        astray = _outliers(survey, residual)
        if len(names) + astray.sum() > _MOST * len(whole):
            return search, found, ()
        if not astray.any():
            break
        rows = _worst_of(astray, residual) if left else astray
        names += _reading_names(survey, rows)
        kept[np.flatnonzero(kept)[rows]] = False
        survey = whole.part_of(kept)
        residual = _left_by(found.terms, survey)
    if not names:
        return search, found, ()
    search = search.on_part(survey, kept)
    return search, search.run(), (_note(names, len(whole)),)


def without_suspects(
    search: Search, explanation: Explanation
) -> tuple[Search, tuple[str, ...]] | None:
    """The search without a few readings that may have led it astray, and a note on them.

    A flexible effect can take up a single bad reading, which then is no outlier. So each effect
    is taken away, and all of them, to see which readings stand alone. None where they are many,
    or there are none.
    """
    survey = search.survey
    suspect = _outliers(survey, explanation.residual) | _outliers(survey, search.nothing.residual)
    for k in range(len(explanation.terms)):
        suspect |= _outliers(survey, search.without(explanation, [k]).residual)
    if not 0 < suspect.sum() <= _MOST_SUSPECTS * len(survey):
        return None
    note = _note(_reading_names(survey, suspect), len(survey))
    return search.on_part(survey.part_of(~suspect), ~suspect), (note,)


def _left_by(terms: Sequence[Term], survey: Survey) -> np.ndarray:
    """What terms, fitted anew, leave of whitened readings, (n,)."""
    whiten, reading = survey.whiten, survey.whiten(survey.residual_mm)
    if not terms:
        return reading
    return absorbing(survey, whiten, fit_terms(survey, terms, whiten))(reading)


def _outliers(survey: Survey, residual: np.ndarray) -> np.ndarray:
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


def _worst_of(astray: np.ndarray, residual: np.ndarray) -> np.ndarray:
    """Of some readings, (n,) bool, those that stand out most.

    They bend what is fitted, so that good ones seem to stand out with them.
    """
    away = np.abs(residual)
    return astray & (away > _AMONG_WORST * away[astray].max())


def _reading_names(survey: Survey, rows: np.ndarray) -> list[str]:
    """File and name of the readings in (n,) bool."""
    names = [f"{m.name} {own}" for m in survey.measurements for own in m.id]
    return [names[k] for k in np.flatnonzero(rows)]


def _note(names: Sequence[str], count: int) -> str:
    """What is said of the readings, of `count`, that were left out."""
    shown = ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
    return f"left out, as they are out of all proportion ({len(names)} of {count}): {shown}"
