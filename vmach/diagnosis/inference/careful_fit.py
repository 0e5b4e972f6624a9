"""A fit that counts what its laws leave open as uncertainty of the readings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vmach.diagnosis.gates.absorbing import slack_of
from vmach.fit.base import Base
from vmach.fit.joint_fit import fit_terms
from vmach.fit.marginal_likelihood import Effects, Posterior
from vmach.fit.sizes import Sizes
from vmach.fit.survey import Survey
from vmach.fit.terms import JointFit

__all__ = ["careful_fit"]

#: times that what the laws leave open is set by the fit before, so that it is a share of the last
_PASSES = 3
#: share of what it explained that a fit explains beside what its laws leave open, at least; chosen.
#: Where the laws are nearly exact it explains all; what explains nothing foretells nothing
_DONE = 0.8


def careful_fit(base: Base, fit: JointFit, sizes: Sizes) -> JointFit:
    """The fit once more, beside members and what its laws leave open.

    Parameters
    ----------
    base : Base
    fit : JointFit
    sizes : Sizes
        Of the members.
    """
    survey, least = base.survey, _DONE * _explained(base.survey, fit)
    for _ in range(_PASSES):
        slack = slack_of(survey, replace(fit, slack_mm=None))
        noise = Posterior(base, sizes, Effects(base.columns(slack)))
        trial = replace(fit_terms(noise, fit.terms), slack_scale=fit.slack_scale)
        if slack.shape[1] == 0:
            return trial
        if _explained(survey, trial) < least:
            # an effect that grows leaves more open, which lets it grow, or does all: not so
            wider = fit_terms(noise, fit.terms, refine=False)
            kept = replace(wider, coefficients=fit.coefficients, slack_scale=fit.slack_scale)
            return replace(kept, slack_mm=slack)
        fit = replace(trial, slack_mm=slack)
    return fit


def _explained(survey: Survey, fit: JointFit) -> float:
    """What a fit takes off the sum of squares of the aligned readings, in stated u."""
    left = survey.residual_mm - sum(fit.explained_mm(k) for k in range(len(fit.terms)))
    both = np.stack([survey.residual_mm, left], axis=1)
    beside_alignment = (both - survey.aligned(both)) / survey.u_mm[:, None]
    before, after = np.sum(beside_alignment**2, axis=0)
    return float(before - after)
