"""Fitting effects that a user names, whatever a diagnosis would say."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from threadpoolctl import threadpool_limits

from vmach.diagnosis.diagnose import explanation_with_slack, prepare_search
from vmach.diagnosis.words import component_directions, component_parameters
from vmach.effects import Effect, catalogue
from vmach.effects.component import Component
from vmach.errors import InputError
from vmach.fit.survey import Survey
from vmach.fit.uncertainty import parameter_uncertainty

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
        Independent changes of the parameters, one standard uncertainty each.
    explained_mm : (n,) float64
        What it does to the readings.
    """

    effect: Effect
    target: str
    parameters: dict
    u: dict
    one_sigma: list[dict]
    explained_mm: np.ndarray

    @property
    def label(self) -> str:
        """Name and target."""
        return f"{self.effect.name} {self.target}".strip()


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
    search = prepare_search(survey, {e.name: e for e, _ in wanted}.values())
    candidates = search.candidates
    explanation = search.nothing
    for effect, target in wanted:
        possible = [
            k
            for k, c in enumerate(candidates)
            if c.effect is effect
            and target in (c.target, None)
            and c.label not in explanation.labels
        ]
        if not possible:
            raise _impossible(survey, effect, target, search.excluded)
        gains = search.gains(explanation)
        explanation = search.extend(explanation, max(possible, key=lambda k: gains[k]))
    explanation = explanation_with_slack(search, explanation)
    fit = explanation.fit
    assert fit is not None
    found = []
    for k, term in enumerate(fit.terms):
        if isinstance(term.effect, Component):
            parameters, u = component_parameters(fit, k, survey.paths[0])
            one_sigma = component_directions(fit, k, survey.paths[0])
        else:
            parameters, one_sigma = fit.parameters(k), fit.directions(k)
            spreads = parameter_uncertainty(survey, fit, k)
            u = {name: spread.u for name, spread in spreads.items()}
        explained = fit.explained_mm(k)
        found.append(NamedEffect(term.effect, term.target, parameters, u, one_sigma, explained))
    return tuple(found)


def _parsed(name: str) -> tuple[Effect, str | None]:
    word, _, target = name.replace(" ", ":").partition(":")
    known = catalogue()
    if word not in known:
        close = difflib.get_close_matches(word, known, n=1)
        raise InputError(
            f"unknown effect '{word}'",
            accepted=", ".join(known),
            hint=f"did you mean '{close[0]}'?" if close else None,
        )
    return known[word], target or None


def _impossible(survey: Survey, effect: Effect, target: str | None, excluded) -> InputError:
    targets = [t for t in effect.possible_targets(survey.job) if t]
    reasons = {t: why for e, t, why in excluded if e is effect}
    why = reasons.get(target or "", "no such target")
    return InputError(
        f"the measurements cannot show {effect.name} {target or ''}".rstrip() + f": {why}",
        file=survey.job.path,
        accepted=", ".join(f"{effect.name}:{t}" for t in targets) or effect.name,
    )
