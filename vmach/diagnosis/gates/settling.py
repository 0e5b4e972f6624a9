"""Settling an explanation: only what helps to predict, refitted with what its laws leave open."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vmach.diagnosis.explanation import Explanation
from vmach.diagnosis.gates.absorbing import slack_of
from vmach.diagnosis.gates.held_out import holds_out
from vmach.diagnosis.search import Search
from vmach.fit.joint_fit import fit_terms
from vmach.fit.whitening import Whitening

__all__ = ["refitted_with_slack", "settled"]

#: times that the slack is set by the fit before, so that it is a share of what is there at last
_PASSES = 3


def settled(search: Search, explanation: Explanation) -> Explanation:
    """Without effects that do not help to predict held-out readings, and refitted carefully."""
    while explanation.fit is not None:
        useful = holds_out(search.survey, explanation.fit)
        if all(useful):
            break
        explanation = search.explain(
            [term for term, good in zip(explanation.terms, useful, strict=True) if good]
        )
    return refitted_with_slack(search, explanation)


def refitted_with_slack(search: Search, explanation: Explanation) -> Explanation:
    """Refitted with what the effects' laws leave open counted as uncertainty."""
    if explanation.fit is None:
        return explanation
    survey, fit = search.survey, explanation.fit
    for _ in range(_PASSES):
        slack = slack_of(survey, replace(fit, slack_mm=None))
        if slack.shape[1] == 0:
            return explanation
        careful = Whitening(survey.u_mm, np.hstack([survey.factors, slack]), survey.nuisance)
        fit = replace(fit_terms(survey, fit.terms, careful), slack_mm=slack)
    return search.explanation_of(fit)
