"""Explanations over the surface that their own effects leave.

Of several contacts that compete for a point, the lowest one makes it. Signatures are of the
contacts that the model alone would choose; effects as large as those that were fitted may choose
others. A linear law holds between two choices.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from vmach.diagnosis.fitted_parameters import fitted_values
from vmach.diagnosis.inference.bank import Bank
from vmach.diagnosis.inference.rules import CLEARLY
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.effects import AtAnyMoment, EffectInstance
from vmach.fit.base import Base
from vmach.fit.candidates import Candidate, candidate_of, gather_candidates
from vmach.fit.marginal_likelihood import Effects, Posterior
from vmach.fit.sizes import Sizes
from vmach.fit.survey import Survey
from vmach.prediction.made_surface import FLOOR

__all__ = ["chosen_by_all", "chosen_by_one", "over_own_contacts"]

#: what other contacts change of the readings, in stated uncertainties, before they matter
_NOTABLE = 0.25


def over_own_contacts(weighing: Weighing, found: Explanation) -> tuple[Weighing, Explanation]:
    """The weighing over those contacts, and the explanation there; as given if none is better."""
    noise, moved = weighing.base.noise, chosen_by_all(weighing, found)
    if moved is None:
        return weighing, found
    effects, excluded = weighing.effects, weighing.excluded
    weighing.release()
    candidates = gather_candidates(moved, effects)[0]
    other = Weighing(moved, candidates, excluded=excluded, noise=noise)
    # an effect may choose contacts that show nothing of it
    shown = {candidate.label for candidate in candidates}
    terms = [term for term in found.terms if term.label in shown]
    return other, other.explain(terms, found.posterior.sizes)


def chosen_by_all(weighing: Weighing, found: Explanation) -> Survey | None:
    """The survey over contacts that the terms of an explanation choose; None where none is better.

    The readings decide: contacts that make them less probable are not the ones that were.
    """
    if found.fit is None:
        return None
    survey, fit = weighing.survey, found.fit
    acting = [
        EffectInstance(term.effect, term.target, fitted_values(fit, k), survey.job)
        for k, term in enumerate(fit.terms)
    ]
    # their moments are fitted over contacts that hold whatever those are
    steps = [AtAnyMoment(one) for one in acting if one.effect.is_sudden]
    moved = survey.made_beside([*acting, *steps])
    made_s = [np.concatenate([path.time_s for path in s.paths]) for s in (survey, moved)]
    if not (_differ(survey, moved, acting) or (steps and np.any(made_s[0] != made_s[1]))):
        return None
    # what was worked out of many readings takes much memory
    weighing.forget()
    other = Weighing(moved, weighing.candidates, noise=weighing.base.noise)
    is_better = other.explain(found.terms, found.posterior.sizes).score > found.score
    return moved if is_better else None


def chosen_by_one(weighing: Weighing) -> tuple[str, Survey] | None:
    """Name and target of an effect, and the survey over contacts that its usual size would choose.

    A play that lifts the tool in one direction of travel is hardly seen over contacts that the
    model alone would choose: where it lifts, another pass makes the floor. That effect is taken
    whose own contacts make the readings the most probable; None where none does so clearly.
    """
    sizes = weighing.nothing().posterior.sizes
    trials = (
        (_gain(weighing, candidate, sizes, moved), candidate.label, moved)
        for candidate in weighing.candidates
        if candidate.effect.follows_travel and _moves_floors(weighing.survey, candidate)
        for moved in _made_beside_usual(weighing.survey, candidate)
    )
    gain, label, moved = max(trials, key=lambda t: t[0], default=(0.0, "", weighing.survey))
    return (label, moved) if gain >= CLEARLY else None


def _moves_floors(survey: Survey, candidate: Candidate) -> bool:
    """Whether an effect of usual size notably moves the tool along its axis, on any floor."""
    moved = np.abs(candidate.signatures_mm).max(axis=(1, 2), initial=0.0) / survey.u_mm
    return bool(np.any(moved[survey.sensing[:, 2] > FLOOR] > _NOTABLE))


def _made_beside_usual(survey: Survey, candidate: Candidate) -> Iterator[Survey]:
    """The survey where contacts are those that an effect of usual size would choose, each sign."""
    effect = candidate.effect
    inner = candidate.grid[int(np.argmax(candidate.log_prior))]
    for sign in (1.0, -1.0):
        usual = {p.name: sign * p.usual for p in effect.amplitudes}
        if sign < 0.0 and all(p.is_size for p in effect.amplitudes):
            continue
        acting = [EffectInstance(effect, candidate.target, {**inner, **usual}, survey.job)]
        moved = survey.made_beside(acting)
        if _differ(survey, moved, acting):
            yield moved


def _gain(weighing: Weighing, candidate: Candidate, sizes: Sizes, moved: Survey) -> float:
    """How much more probable other contacts make the readings, with a candidate alone."""
    own = candidate_of(moved, candidate.effect, candidate.target)
    if own is None:
        return 0.0
    here = weighing.base
    there = Base(moved, here.noise, weighing.members)
    without, beside = _without_and_with(here, candidate, sizes)
    return _without_and_with(there, own, sizes)[1] - max(without, beside)


def _without_and_with(base: Base, candidate: Candidate, sizes: Sizes) -> tuple[float, float]:
    """Log probability of readings without a candidate, and with it."""
    nothing = Posterior(base, sizes, Effects(base.no_columns))
    evidence = Bank(base, [candidate]).evidence(nothing)
    return nothing.log_probability, nothing.log_probability + float(evidence.log_factor[0, 0])


def _differ(survey: Survey, moved: Survey, acting: Sequence[EffectInstance]) -> bool:
    """Whether other contacts notably change what model and effects foretell."""
    change = moved.foretold_mm(acting) - survey.foretold_mm(acting)
    return bool(np.any(np.abs(change) > _NOTABLE * survey.u_mm))
