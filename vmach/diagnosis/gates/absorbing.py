"""Taking fitted effects out of readings, with all that is open about them."""

from __future__ import annotations

import numpy as np

from vmach.fit.survey import Survey
from vmach.fit.terms import JointFit
from vmach.fit.whitening import Whiten, Whitening

__all__ = ["absorbing", "slack_of", "stated_slack"]


def absorbing(survey: Survey, whiten: Whiten, fit: JointFit) -> Whitening:
    """Takes the effects of a fit out of whitened readings: amplitudes, inner parameters, slack.

    Parameters
    ----------
    survey : Survey
    whiten : callable
        Turns readings of the survey into plain unit noise.
    fit : JointFit
    """
    none = np.zeros((len(survey), 0))
    free, random = [none], [slack_of(survey, fit)]
    for k, term in enumerate(fit.terms):
        if term.width is None:
            free.append(fit.signatures[k].mm)
            random.append(fit.tangents[k].mm * term.spread_of_inner)
        else:
            random.append(term.width * fit.signatures[k].mm)
    return Whitening(np.ones(len(survey)), whiten(np.hstack(random)), whiten(np.hstack(free)))


def slack_of(survey: Survey, fit: JointFit) -> np.ndarray:
    """Unit-variance signatures of what the laws of a fit's effects leave open, (n, K) mm.

    Those that a careful fit counted; else of all its terms.
    """
    if fit.slack_mm is not None:
        return fit.slack_mm
    return fit.slack_scale * stated_slack(survey, fit)


def stated_slack(survey: Survey, fit: JointFit) -> np.ndarray:
    """What the laws of all terms state, (n, K) mm."""
    parts = [
        survey.slack(term.effect, term.target, fit.parameters(k))
        for k, term in enumerate(fit.terms)
        if term.effect.slack_share > 0.0
    ]
    return np.hstack([np.zeros((len(survey), 0)), *parts])
