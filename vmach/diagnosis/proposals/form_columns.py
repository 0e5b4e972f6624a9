"""Signatures of all forms over the readings of a survey, some at a time."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from vmach.diagnosis.proposals.form import USUAL_UM, Form, FormEffect
from vmach.diagnosis.proposals.states import CONSTANT, DIRECTIONS, Direction, State, states_of
from vmach.fit.candidates import Candidate
from vmach.fit.survey import Survey

__all__ = ["FormColumns"]

#: forms that are weighed together
_AT_ONCE = 500
#: a form that differs by less than this among the readings, mm, does not show
_BLIND_MM = 1e-9


class FormColumns:
    """Every product of two states into every direction.

    Parameters
    ----------
    survey : Survey
    """

    def __init__(self, survey: Survey) -> None:
        self._survey = survey
        self._states = _states(survey)
        self._sensed = {direction: _sensed(survey, direction) for direction in DIRECTIONS}
        pairs = itertools.combinations_with_replacement(self._states, 2)
        self.forms = [Form(*pair, direction) for pair in pairs for direction in DIRECTIONS]

    def __len__(self) -> int:
        return len(self.forms)

    def column(self, form: Form) -> np.ndarray:
        """Signature of a usual amount, (n,) mm."""
        product = self._states[form.first] * self._states[form.second]
        return 1e-3 * USUAL_UM * product * self._sensed[form.direction]

    def direction_of(self, form: Form) -> np.ndarray:
        """The signature with alignment taken off, of unit length, (n,)."""
        column = self.column(form)
        left = column - self._survey.aligned(column[:, None])[:, 0]
        return left / max(float(np.linalg.norm(left)), 1e-300)

    def candidate(self, form: Form) -> Candidate:
        """The form as a candidate of a search."""
        effect, column = FormEffect(form), self.column(form)
        return Candidate(effect, form.formula, [{}], np.zeros(1), column[:, None, None])

    def batches(self) -> Iterator[list[Form]]:
        """Forms that show, some at a time."""
        for k in range(0, len(self.forms), _AT_ONCE):
            some = self.forms[k : k + _AT_ONCE]
            if shown := [form for form in some if np.ptp(self.column(form)) > _BLIND_MM]:
                yield shown


def _states(survey: Survey) -> dict[State, np.ndarray]:
    """All states that differ among the readings, with their values (n,)."""
    listed = dict.fromkeys(state for path in survey.paths for state in states_of(survey.job, path))
    found: dict[State, np.ndarray] = {CONSTANT: np.ones(len(survey))}
    for state in listed:
        values = [
            state.at(path) if m.on_part or not state.needs_surface else np.zeros(len(m))
            for path, m in zip(survey.paths, survey.measurements, strict=True)
        ]
        value = np.concatenate(values)
        if np.ptp(value) > 0.0:
            found[state] = value
    return found


def _sensed(survey: Survey, direction: Direction) -> np.ndarray:
    """How readings sense a unit displacement into a direction, (n,); tilts sense none."""
    parts = [
        np.einsum("pi,pi->p", m.sensing, direction.at(path))
        if (m.on_part or not direction.needs_surface) and path.states.arm_mm is None
        else np.zeros(len(m))
        for path, m in zip(survey.paths, survey.measurements, strict=True)
    ]
    return np.concatenate(parts)
