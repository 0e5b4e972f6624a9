"""What parameters are where nobody noted the times of a test, averaged over possible clocks.

A time constant is known no better than the clock. What is found is fitted once more by each other
clock that is possible; the interval holds all of them, each as probable as the readings are by it.

Source: J. Hoeting, D. Madigan, A. Raftery and C. Volinsky, Bayesian Model Averaging: A Tutorial,
Statist. Sci. 14 (1999) 382, eqs. 1 and 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vmach.diagnosis.gates.absorbing import slack_of
from vmach.fit.base import Base
from vmach.fit.clocks import by_other_clocks
from vmach.fit.joint_fit import fit_terms
from vmach.fit.marginal_likelihood import Effects, Posterior
from vmach.fit.noise.discrepancy import members_of
from vmach.fit.sizes import Sizes
from vmach.fit.survey import Survey
from vmach.fit.terms import JointFit
from vmach.fit.uncertainty import Otherwise

__all__ = ["at_other_clocks"]


def at_other_clocks(fit: JointFit) -> Sequence[Sequence[Otherwise]]:
    """Of each term of a fit what it is by other clocks; nothing where all times were noted.

    Parameters
    ----------
    fit : JointFit
    """
    others = list(by_other_clocks(fit.posterior.base.survey))
    if not others:
        return [()] * len(fit.terms)
    here, there = _fitted(fit, fit.posterior.base.survey), []
    for other in others:
        by_it = _fitted(fit, other.survey)
        weight = other.weight * np.exp(min(_log_probability(by_it) - _log_probability(here), 0.0))
        there.append((float(weight), by_it))
    every = range(len(fit.terms))
    return [[_otherwise(weight, here, by_it, k) for weight, by_it in there] for k in every]


def _fitted(fit: JointFit, survey: Survey) -> JointFit:
    """The terms of a fit over a survey by another clock, beside members of the same sizes."""
    known = fit.posterior.base
    base = Base(survey, known.noise, members_of(survey, known.members.plain_mm))
    slack = base.columns(slack_of(survey, replace(fit, slack_mm=None)))
    sizes = _sizes(fit.posterior.sizes, known, base)
    return fit_terms(Posterior(base, sizes, Effects(slack)), fit.terms)


def _sizes(known: Sizes, base: Base, other: Base) -> Sizes:
    """Sizes of the members of one base for those of another, by their names."""
    size = dict(zip(base.members.names, known.members, strict=True))
    return Sizes(known.factor, tuple(size.get(name, 0.0) for name in other.members.names))


def _log_probability(fit: JointFit) -> float:
    """Of the readings with the terms of a fit, their coefficients integrated."""
    of_coefficients = [
        np.full(len(c), t.prior_width) for t, c in zip(fit.terms, fit.coefficients, strict=True)
    ]
    widths = np.concatenate([*of_coefficients, *(t.spread_of_inner for t in fit.terms)])
    every = fit.posterior.effects.columns.beside(fit.open.scaled(widths))
    unusual = sum(float(term.unusual @ term.unusual) for term in fit.terms)
    return replace(fit.posterior, effects=Effects(every)).log_probability - 0.5 * unusual


def _otherwise(weight: float, here: JointFit, there: JointFit, k: int) -> Otherwise:
    """Term k by another clock.

    A time constant changes by a factor; its tangent times what the factor is beyond one is exact.
    """
    before, after = here.terms[k], there.terms[k]
    times = np.array([after.inner[name] / before.inner[name] for name in before.free_inner])
    moved = np.concatenate([there.coefficients[k] - here.coefficients[k], times - 1.0])
    scale = np.concatenate([np.ones(len(here.coefficients[k])), times])
    more = there.covariance[k] * np.outer(scale, scale) - here.covariance[k]
    return Otherwise(weight, moved, more)
