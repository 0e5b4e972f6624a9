"""What zeros that were touched on the machine take off the signatures of forms."""

from __future__ import annotations

from functools import cache

import numpy as np

from vmach.diagnosis.proposals.form import USUAL_UM, Form
from vmach.diagnosis.proposals.states import Direction, State
from vmach.fit.survey import Survey
from vmach.path.circumstances import Circumstances
from vmach.path.touched_zero import TouchedZero, touched_zero

__all__ = ["TouchedZeros"]


class TouchedZeros:
    """The touches of a survey's parts, where the job says how zeros were set.

    Parameters
    ----------
    survey : Survey
    """

    def __init__(self, survey: Survey) -> None:
        self._sensing = [m.sensing for m in survey.measurements]
        self._zeros = [_of_part(path) for path in survey.paths]
        self._state = cache(self._of_state)
        self._direction = cache(self._of_direction)

    def __bool__(self) -> bool:
        return any(zero is not None for zero in self._zeros)

    def columns_mm(self, form: Form) -> np.ndarray:
        """What is taken off the readings by a usual amount each, (n, K) mm."""
        first, second = self._state(form.first), self._state(form.second)
        taken = []
        for k, (zero, sensing) in enumerate(zip(self._zeros, self._sensing, strict=True)):
            directions = self._direction(form.direction)[k]
            product = (first[k][:, :, None] * second[k][:, None, :]).reshape(len(first[k]), -1)
            moved = directions[:, :, :, None] * product[:, None, None, :]
            moved = moved.reshape(len(moved), 3, -1)
            if zero is None:
                taken.append(np.zeros((len(sensing), moved.shape[2])))
            else:
                taken.append(np.einsum("pi,pik->pk", sensing, zero[0].shift_mm(moved)))
        return 1e-3 * USUAL_UM * np.concatenate(taken)

    def _of_state(self, state: State) -> list[np.ndarray]:
        """Its values at the touches of each measurement; one of zero where there are none."""
        found = [None if zero is None else state.at(zero[1]) for zero in self._zeros]
        wide = next(value.shape[1] for value in found if value is not None)
        return [np.zeros((1, wide)) if value is None else value for value in found]

    def _of_direction(self, direction: Direction) -> list[np.ndarray]:
        """The same of a direction, (T, 3, D)."""
        found = [None if zero is None else direction.at(zero[1]) for zero in self._zeros]
        wide = next(value.shape[2] for value in found if value is not None)
        return [np.zeros((1, 3, wide)) if value is None else value for value in found]


def _of_part(path: Circumstances) -> tuple[TouchedZero, Circumstances] | None:
    """Touches that a part's zero was set by; other measurements have zeros of their own."""
    zero = None if path.states.normal is None else touched_zero(path.job, path.states)
    return None if zero is None else (zero, Circumstances(zero.states, path.job, path.variant))
