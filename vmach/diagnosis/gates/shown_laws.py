"""Are the laws of an explanation shown by the readings, or would less than laws do as well?"""

from __future__ import annotations

import numpy as np

from vmach.diagnosis.explanation import MARGIN, Explanation
from vmach.diagnosis.residuals.single_features import AgainstOffsets, against_offsets
from vmach.diagnosis.score import numbers_determined
from vmach.diagnosis.search import Search
from vmach.fit.terms import JointFit

__all__ = ["laws_not_shown", "share_left_to_slack"]

#: by so many standard deviations more than noise is taken up
_SURELY = 2.0


def laws_not_shown(search: Search, explanation: Explanation) -> tuple[dict[str, float], list[str]]:
    """Laws that say no more than something plainer does: why, and in words.

    Plainer are offsets of the places where an effect shows, or where several do together, and
    the inexactness that the laws are granted.
    """
    left, notes = {}, []
    terms = explanation.fit.terms if explanation.fit else ()
    needs_slack = _needs_slack(search, explanation)
    for k, term in enumerate(terms):
        found = against_offsets(search, explanation, [k])
        # numbers of the slack are not counted, so a law that needs it has to show more clearly
        is_vague = needs_slack and term.effect.slack_share > 0.0 and found.gain < MARGIN
        if is_vague or not found.is_shown:
            left |= _why(found)
            notes.append(
                f"{term.label} would fit, with {found.numbers:.0f} numbers for "
                f"{found.places:.0f} independent offsets where it shows: "
                "these readings do not show its law"
            )
    if len(terms) > 1:
        together = against_offsets(search, explanation, range(len(terms)))
        if together.gain < MARGIN * len(terms):
            left |= _why(together)
            notes.append(
                f"{' and '.join(t.label for t in terms)} would fit together, but so would "
                "offsets of the places where they show"
            )
    share, granted = share_left_to_slack(search, explanation)
    if share > granted:
        left["inexactness of the laws"] = share
    return left, notes


def _why(found: AgainstOffsets) -> dict[str, float]:
    if found.gain < 0.0:
        return {"offsets of single features": -found.gain}
    return {"as many numbers as places": found.numbers}


def _needs_slack(search: Search, explanation: Explanation) -> bool:
    """Whether the inexactness of the laws surely takes up more than noise."""
    fit = explanation.fit
    if fit is None or fit.slack_mm is None:
        return False
    numbers = numbers_determined(search.whiten(fit.slack_mm))
    taken = _square_by_law(search, fit) - float(explanation.residual @ explanation.residual)
    return taken > numbers + _SURELY * np.sqrt(2.0 * numbers)


def _square_by_law(search: Search, fit: JointFit) -> float:
    """Sum of squares that the laws leave as they are stated."""
    stated_mm = sum(fit.explained_mm(k) for k in range(len(fit.terms)))
    return float(np.sum(search.whiten(search.survey.residual_mm - stated_mm) ** 2))


def share_left_to_slack(search: Search, explanation: Explanation) -> tuple[float, float]:
    """What inexactness of the laws explains, as a share of what it and these laws do.

    Returns
    -------
    share : float
        Of the sums of squares.
    granted : float
        The largest `slack_share` of the laws: being a share of the amplitude it is generous.
        With circumstances that no file tells, the share that is expected, where that is more.
    """
    fit = explanation.fit
    if fit is None or fit.slack_mm is None:
        return 0.0, 0.0
    inexact = [k for k, term in enumerate(fit.terms) if term.effect.slack_share > 0.0]
    left = search.without(explanation, inexact).residual
    without = float(left @ left)
    by_law = _square_by_law(search, fit)
    end = float(explanation.residual @ explanation.residual)
    open_causes = search.whiten(fit.slack_mm)
    explained = max(without - end - numbers_determined(open_causes), 1.0)
    share = max(by_law - end - numbers_determined(open_causes), 0.0) / explained
    granted = max(term.effect.slack_share for term in fit.terms)
    if any(term.effect.has_untold for term in fit.terms):
        granted = max(granted, float(np.sum(open_causes**2)) / explained)
    return share, granted
