"""Fitting effects that a user names, whatever a diagnosis would say."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from vmach.diagnosis.component_curve import component_directions
from vmach.diagnosis.fitted_parameters import FittedParameters, fitted_parameters
from vmach.diagnosis.inference.by_definition import beyond_slopes
from vmach.diagnosis.inference.noise import noise_after
from vmach.diagnosis.inference.own_contacts import over_own_contacts
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.inference.support import supports_of
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.diagnosis.other_clocks import at_other_clocks
from vmach.diagnosis.proposals.forms import Forms
from vmach.effects import Effect, catalogue, label_of
from vmach.effects.catalogue import unknown_effect_hint
from vmach.errors import InputError
from vmach.fit.other_sizes import beside_other_sizes
from vmach.fit.survey import Survey
from vmach.fit.terms import JointFit

__all__ = ["NamedEffect", "fit_named"]


@dataclass(frozen=True)
class NamedEffect:
    """An effect with fitted parameters.

    Attributes
    ----------
    effect : Effect
    target : str
    parameters, u : dict
        As in ``[effects.NAME]`` of a job, and their standard uncertainties.
    one_sigma : list of dict
        D independent changes of the parameters, one standard uncertainty each.
    correlations : mapping of label to (E, D) float64
        Correlation coefficients of the E changes of each effect before it with these.
    explained_mm : (n,) float64
        What it does to the readings.
    is_called_for : bool
        Whether the readings speak for it, given the others, more than clean ones ever would.
    """

    effect: Effect
    target: str
    parameters: dict
    u: dict
    one_sigma: list[dict]
    correlations: dict[str, np.ndarray]
    explained_mm: np.ndarray
    is_called_for: bool

    @property
    def label(self) -> str:
        """Name and target."""
        return label_of(self.effect.name, self.target)


@threadpool_limits.wrap(limits=1, user_api="blas")
def fit_named(survey: Survey, names: Sequence[str]) -> tuple[NamedEffect, ...]:
    """Fit named effects together.

    Parameters
    ----------
    survey : Survey
    names : sequence of str
        ``NAME`` or ``NAME:TARGET``.

    Raises
    ------
    InputError
        Unknown effect or target, or one that the measurements cannot show.
    """
    wanted = [_parsed(name) for name in names]
    weighing = prepare_weighing(survey, {e.name: e for e, _ in wanted}.values())
    # what is asked for goes before what nobody models, which could take its place
    found = weighing.small()
    for effect, target in wanted:
        found = _extended(weighing, found, effect, target)
    found = weighing.explain(found.terms, weighing.small().posterior.sizes)
    weighing, found = over_own_contacts(weighing, found)
    noise = noise_after(weighing, found)
    if noise is not None:
        weighing = weighing.with_noise(noise)
        found = weighing.explain(found.terms, found.posterior.sizes)
    own = [weighing.candidates[weighing.index_of(term.label)] for term in found.terms]
    weighing, found = beyond_slopes(weighing, found, own)
    return _named_beside_forms(weighing, found)


def _named_beside_forms(weighing: Weighing, found: Explanation) -> tuple[NamedEffect, ...]:
    """The effects beside forms for what remains; parameters would make up for that else.

    A form that holds one of them, as a turn with its arms holds a scale, would take its place.
    """
    forms, count = Forms(weighing, found), len(found.terms)
    grown = forms.added(found)
    beside = [
        form for form in grown.terms[count:]
        if not any(forms.holds(found, k, form) for k in range(count))
    ]  # fmt: skip
    weighing = forms.among(beside)
    terms = [*grown.terms[:count], *beside]
    told = weighing.explain(terms, grown.posterior.sizes, resize=len(terms) < len(grown.terms))
    fit = weighing.careful(told)
    assert fit is not None
    by_clock, of_sizes = at_other_clocks(fit), beside_other_sizes(fit)
    units: list[np.ndarray] = []
    named = []
    for k, support in enumerate(supports_of(weighing, told, count)):
        fitted = fitted_parameters(fit, k, of_sizes[k], by_clock[k])
        effect, unit = _named_effect(fitted, fit, k, is_called_for=support.is_shown)
        correlations = {
            named[i].label: before @ fit.cross_covariance(i, k) @ unit.T
            for i, before in enumerate(units)
        }
        units.append(unit)
        named.append(replace(effect, correlations=correlations))
    return tuple(named)


def _extended(
    weighing: Weighing, explanation: Explanation, effect: Effect, target: str | None
) -> Explanation:
    """An explanation with a further effect; without a target the one that fits best is taken."""
    possible = [
        k
        for k, c in enumerate(weighing.candidates)
        if c.effect is effect and target in (c.target, None) and c.label not in explanation.labels
    ]
    if not possible:
        raise _impossible(weighing, effect, target, explanation.labels)
    gains = weighing.gains(explanation)
    return weighing.extend(explanation, max(possible, key=lambda k: gains[k]))


def _named_effect(
    fitted: FittedParameters, fit: JointFit, k: int, *, is_called_for: bool
) -> tuple[NamedEffect, np.ndarray]:
    """Term k of a fit, with the uncertainty that goes into a job.

    Returns
    -------
    NamedEffect
        Its correlations with others are left out.
    (D, K + I) float64
        What its coefficients and inner logarithms make of each of its D changes.
    """
    term = fit.terms[k]
    if term.effect.corrects_table:
        path = fit.posterior.base.survey.paths[0]
        one_sigma, unit = component_directions(fit, k, path)
    else:
        # another wave that reads the same is no small change, and shared with no other effect
        near, unit = _as_wide_as(fitted.near_u, fit.directions(k)), fit.unit_changes(k)
        one_sigma = [*near, *fitted.leaps]
        unit = np.vstack([unit, np.zeros((len(fitted.leaps), unit.shape[1]))])
    moves = [k for k, change in enumerate(one_sigma) if any(np.any(v) for v in change.values())]
    named = NamedEffect(
        effect=term.effect,
        target=term.target,
        parameters=fitted.values,
        u=fitted.u,
        one_sigma=[one_sigma[k] for k in moves],
        correlations={},
        explained_mm=fit.explained_mm(k),
        is_called_for=is_called_for,
    )
    return named, unit[moves]


def _as_wide_as(u: Mapping[str, float], changes: Sequence[Mapping[str, float]]) -> list[dict]:
    """Independent changes that together are as wide as the standard uncertainties.

    Along tangents they are too wide or too narrow where a law is bent within its uncertainty. A
    change keeps its direction, in which parameters make up for each other; its length is that
    which the parameters ask for that it makes most of.
    """
    names = list(u)
    along = np.array([[change[name] for name in names] for change in changes])
    squared = np.square(along)
    wide = squared.sum(axis=0)
    moved = wide > 0.0
    share = squared[:, moved] / wide[moved]
    asked = np.square([u[name] for name in names])[moved] / wide[moved]
    total = share.sum(axis=1)
    factor = np.sqrt(np.divide(share @ asked, total, out=np.ones_like(total), where=total > 0.0))
    return [dict(zip(names, row, strict=True)) for row in (factor[:, None] * along).tolist()]


def _parsed(name: str) -> tuple[Effect, str | None]:
    word, _, target = name.replace(" ", ":").partition(":")
    known = catalogue()
    if word not in known:
        raise InputError(
            f"unknown effect '{word}'", accepted=", ".join(known), hint=unknown_effect_hint(word)
        )
    return known[word], target or None


def _impossible(
    weighing: Weighing, effect: Effect, target: str | None, chosen: Collection[str]
) -> InputError:
    """Why an effect cannot be fitted, and with which targets it could be."""
    label = label_of(effect.name, target or "")
    targets = effect.possible_targets(weighing.survey.job)
    reasons = {t: why for e, t, why in weighing.excluded if e is effect}
    free = [c for c in weighing.candidates if c.effect is effect and c.label not in chosen]
    if target is not None and target not in targets:
        what = f"{effect.name} has no target '{target}'"
    elif any(c.effect is effect and c.label in chosen for c in weighing.candidates):
        what = f"{label} is named twice"
    elif not targets:
        what = f"this job has nothing that {effect.name} could act on"
    else:
        why = reasons[targets[0] if target is None else target]
        what = f"the measurements cannot show {label}: {why}"
    accepted = [f"{effect.name}:{c.target}" if c.target else effect.name for c in free]
    return InputError(what, file=weighing.survey.job.path, accepted=", ".join(accepted) or None)
