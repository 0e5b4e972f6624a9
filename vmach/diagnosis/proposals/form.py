"""A form: states, multiplied, into a direction; an effect like those of the catalogue."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.diagnosis.proposals.states import CONSTANT, Direction, State
from vmach.effects import Effect, linear
from vmach.job import Job
from vmach.path.circumstances import Circumstances

__all__ = ["Form", "FormEffect"]

#: usual size of an amount, um for states of one
USUAL_UM = 5.0


@dataclass(frozen=True)
class Form:
    """amount x first state x second state, into a direction."""

    first: State
    second: State
    direction: Direction

    @property
    def states(self) -> tuple[State, ...]:
        """Those that are not constant."""
        return tuple(s for s in (self.first, self.second) if s is not CONSTANT)

    @property
    def formula(self) -> str:
        """In words."""
        product = " x ".join(s.words for s in self.states) or "a shift"
        return f"{product}, {self.direction.words}"

    @property
    def refute(self) -> str:
        """The test that would refute it, in words."""
        vary = " and ".join(dict.fromkeys(s.kind for s in self.states)) or "place"
        return f"measure again with another {vary} and all else the same: readings have to follow"

    @property
    def kinds(self) -> frozenset[str]:
        """Kinds of its states."""
        return frozenset(s.kind for s in self.states)


class FormEffect(Effect):
    """The effect of a form."""

    name = "form"
    title = "a form over states"
    parameters = (linear("amount_um", "displacement at states of one", usual=USUAL_UM),)
    targets = ("",)

    def __init__(self, form: Form) -> None:
        self.form = form
        self.needs_surface = form.direction.needs_surface

    def possible_targets(self, job: Job) -> tuple[str, ...]:
        return (self.form.formula,)

    def displacement(self, path: Circumstances, target: str, amount_um: float) -> np.ndarray:
        product = self.form.first.at(path) * self.form.second.at(path)
        return 1e-3 * amount_um * product[:, None] * self.form.direction.at(path)
