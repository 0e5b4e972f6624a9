"""Ranked forms for what remains: weighed by the same evidence, beside the same discrepancy."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from vmach.diagnosis.inference.bank import Bank
from vmach.diagnosis.inference.rules import SHOWN
from vmach.diagnosis.inference.verdicts import Inference
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.diagnosis.proposals.form import USUAL_UM, Form, FormEffect
from vmach.diagnosis.proposals.held_out import held_out_um
from vmach.diagnosis.proposals.states import CONSTANT, DIRECTIONS, State, states_of
from vmach.fit.candidates import Candidate
from vmach.fit.marginal_likelihood import Sizes
from vmach.fit.survey import Survey

__all__ = ["Proposal", "proposals_of"]

#: forms that are weighed together
_AT_ONCE = 400
#: forms that are fitted, by their evidence beside the discrepancy and nearly without it
_FITTED = 8
#: proposals that are told
_TOLD = 3
#: sizes in u of a discrepancy that leaves a form to show
_SMALL = 0.3
#: a form whose readings follow another one's that closely is the same
_SAME = 0.98


@dataclass(frozen=True)
class Proposal:
    """A form that would explain what remains.

    Attributes
    ----------
    form : Form
    amount_um, u_um : float
        Amplitude with its standard uncertainty.
    odds : float
        Log odds beside the effects that are shown and the discrepancy.
    remains_um : float
        What would remain with it.
    held_out_um : (float, float)
        Root mean square of features that were not fitted, without and with it.
    """

    form: Form
    amount_um: float
    u_um: float
    odds: float
    remains_um: float
    held_out_um: tuple[float, float]


def proposals_of(found: Inference) -> tuple[Proposal, ...]:
    """The leading forms for what remains, the most probable first; none where it is noise."""
    if not found.is_structure:
        return ()
    survey = found.weighing.survey
    states = _states(survey)
    number = len(states) * (len(states) + 1) // 2 * len(DIRECTIONS)
    leading = _leading(found, states)
    known = [found.weighing.candidates[found.weighing.index_of(t.label)]
             for t in found.explanation.terms]  # fmt: skip
    candidates = [*known, *(_candidate(survey, form, states) for form in leading)]
    prices = -float(np.log(number))
    weighing = _Priced(survey, candidates, noise=found.weighing.base.noise).priced(prices)
    start = weighing.explain(found.explanation.terms, found.explanation.posterior.sizes)
    trials = [weighing.extend(start, len(known) + k) for k in range(len(leading))]
    ranked = sorted(zip(trials, leading, strict=True), key=lambda both: -both[0].score)
    told: list[Proposal] = []
    kinds: list[frozenset[str]] = []
    for trial, form in ranked:
        odds = trial.score - start.score
        if odds < SHOWN or len(told) == _TOLD:
            break
        if form.kinds in kinds:
            continue
        proposal = _proposal(weighing, start, trial, form, odds)
        if proposal.held_out_um[1] < proposal.held_out_um[0]:
            told.append(proposal)
            kinds.append(form.kinds)
    return tuple(told)


class _Priced(Weighing):
    """A weighing in which every form costs the logarithm of the number of forms."""

    price = 0.0

    def priced(self, price: float) -> _Priced:
        self.price = price
        return self

    def log_prior(self, candidate: Candidate) -> float:
        return self.price if isinstance(candidate.effect, FormEffect) else 0.0


def _proposal(
    weighing: Weighing, start: Explanation, trial: Explanation, form: Form, odds: float
) -> Proposal:
    from vmach.diagnosis.inference.verdicts import remains_um

    fit = trial.fit
    assert fit is not None
    last = len(fit.terms) - 1
    return Proposal(
        form=form,
        amount_um=fit.parameters(last)["amount_um"],
        u_um=fit.uncertainty(last)["amount_um"],
        odds=odds,
        remains_um=remains_um(weighing, trial),
        held_out_um=held_out_um(weighing.survey, fit, last),
    )


def _states(survey: Survey) -> dict[State, np.ndarray]:
    """All states that differ among the readings, with their values (n,)."""
    listed = dict.fromkeys(state for path in survey.paths for state in states_of(survey.job, path))
    found: dict[State, np.ndarray] = {CONSTANT: np.ones(len(survey))}
    for state in listed:
        values = [
            state.at(path)
            if path.states.normal is not None or ("normal" not in state.code
            and "radial" not in state.code)
            else np.zeros(len(path))
            for path in survey.paths
        ]  # fmt: skip
        value = np.concatenate(values)
        if np.ptp(value) > 0.0:
            found[state] = value
    return found


def _sensed(survey: Survey, form_direction) -> np.ndarray:
    """How readings sense a unit displacement into a direction, (n,)."""
    return np.concatenate([
        np.einsum("pi,pi->p", m.sensing, form_direction.at(path))
        if m.on_part or not form_direction.needs_surface else np.zeros(len(m))
        for path, m in zip(survey.paths, survey.measurements, strict=True)
    ])  # fmt: skip


def _forms(states: Sequence[State]) -> Iterator[tuple[State, State]]:
    return itertools.combinations_with_replacement(states, 2)


def _leading(found: Inference, states: dict[State, np.ndarray]) -> list[Form]:
    """Forms worth a fit, weighed beside what was found, with the discrepancy and nearly without."""
    survey, here = found.weighing.survey, found.explanation.posterior
    small = Sizes(min(here.sizes.factor, 2.0), tuple(min(s, _SMALL) for s in here.sizes.members))
    views = (here, replace(here, sizes=small))
    sensed = {direction: _sensed(survey, direction) for direction in DIRECTIONS}
    gains: tuple[list[float], list[float]] = ([], [])
    forms: list[Form] = []
    every = [
        Form(first, second, direction)
        for first, second in _forms(list(states))
        for direction in DIRECTIONS
    ]
    for k in range(0, len(every), _AT_ONCE):
        some = every[k : k + _AT_ONCE]
        columns = [_column(form, states, sensed) for form in some]
        kept = [(f, c) for f, c in zip(some, columns, strict=True) if np.ptp(c) > 1e-9]
        if not kept:
            continue
        bank = Bank(
            found.weighing.base,
            [Candidate(None, "", [{}], np.zeros(1), c[:, None, None]) for _, c in kept],
        )
        forms += [f for f, _ in kept]
        for view, found_gains in zip(views, gains, strict=True):
            found_gains += [float(e.log_factor[0]) for e in bank.evidence(view)]
    chosen: list[Form] = []
    for view_gains in gains:
        taken: list[np.ndarray] = []
        for k in np.argsort(-np.array(view_gains)):
            column = _aligned(survey, _column(forms[k], states, sensed))
            if view_gains[k] < SHOWN or len(taken) == _FITTED:
                break
            if all(abs(column @ other) < _SAME for other in taken):
                taken.append(column)
                if forms[k] not in chosen:
                    chosen.append(forms[k])
    return chosen


def _column(form: Form, states: dict[State, np.ndarray], sensed: dict) -> np.ndarray:
    """Signature of a usual amount, (n,) mm."""
    product = states[form.first] * states[form.second]
    return 1e-3 * USUAL_UM * product * sensed[form.direction]


def _aligned(survey: Survey, column: np.ndarray) -> np.ndarray:
    """The column of unit length, alignment taken off."""
    left = column - survey.aligned(column[:, None])[:, 0]
    return left / max(float(np.linalg.norm(left)), 1e-300)


def _candidate(survey: Survey, form: Form, states: dict[State, np.ndarray]) -> Candidate:
    effect = FormEffect(form)
    column = _column(form, states, {form.direction: _sensed(survey, form.direction)})
    return Candidate(effect, form.formula, [{}], np.zeros(1), column[:, None, None])
