"""A form: states, multiplied, into a direction; an effect like those of the catalogue."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import cache

import numpy as np

from vmach.diagnosis.proposals.refuting import ELSEWHERE, TILT, refuting_tests
from vmach.diagnosis.proposals.states import CONSTANT, MOTION, Direction, State
from vmach.effects import Displaced, Effect, Parameter, linear
from vmach.job import Job
from vmach.path.circumstances import Circumstances

__all__ = ["Form", "FormEffect", "amounts"]

#: usual size of an amount, um for states of one
USUAL_UM = 5.0


@dataclass(frozen=True)
class Form:
    """amount x first state x second state, into a direction.

    Where a state has several numbers, or the direction is several, each has its own amount.
    """

    first: State
    second: State
    direction: Direction

    def __hash__(self) -> int:
        return hash((self.first.code, self.second.code, self.direction.code))

    @property
    def both(self) -> tuple[State, State]:
        """Its states, constant ones too."""
        return self.first, self.second

    @property
    def states(self) -> tuple[State, ...]:
        """Those that are not constant."""
        return tuple(s for s in (self.first, self.second) if s is not CONSTANT)

    @property
    def needs_surface(self) -> bool:
        """Whether it has a meaning on machined surfaces alone."""
        return self.direction.needs_surface or any(s.needs_surface for s in self.states)

    @property
    def follows_travel(self) -> bool:
        """Whether passes over one place of a floor may differ by it."""
        return bool(self.kinds & MOTION)

    @property
    def formula(self) -> str:
        """In words."""
        words = [s.words for s in self.states] or ["a shift"] * (not self.direction.lever)
        return ", ".join([*filter(None, [" x ".join(words)]), self.direction.words])

    @property
    def label(self) -> str:
        """Of its candidate: name of the effect, and target."""
        return f"form {self.formula}"

    @property
    def state_words(self) -> tuple[str, ...]:
        """States and places that it depends on."""
        return (*(state.words for state in self.states), *self.direction.lever)

    @property
    def each(self) -> tuple[str, ...]:
        """Of several amounts, what each is of, in words."""
        every = itertools.product(self.direction.each, self.first.each, self.second.each)
        return tuple(", ".join(filter(None, words)) for words in every)

    @property
    def refute(self) -> str:
        """What to do that would refute it, and what has to be seen if it is true."""
        if self.direction.turns_tool:
            return TILT
        return refuting_tests(self.states) or ELSEWHERE

    @property
    def kinds(self) -> frozenset[str]:
        """Kinds of its states."""
        return frozenset(s.kind for s in self.states) | {"position" for _ in self.direction.lever}

    @property
    def looked_at(self) -> float:
        """How many like it were tried before it was put on the list."""
        return self.first.looked_at * self.second.looked_at

    def at(self, path: Circumstances) -> np.ndarray:
        """Displacements of one unit of each amount, (P, 3, K), or tilts."""
        product = self.first.at(path)[:, :, None] * self.second.at(path)[:, None, :]
        product = product.reshape(len(path), 1, 1, -1)
        return (self.direction.at(path)[:, :, :, None] * product).reshape(len(path), 3, -1)


class FormEffect(Effect):
    """The effect of a form with `count` amounts."""

    name = "form"
    title = "a form over states"
    targets = ("",)

    def __init__(self, form: Form, count: int = 1) -> None:
        self.form = form
        self.follows_travel = form.follows_travel
        self.needs_surface = form.needs_surface
        self.turns_tool = form.direction.turns_tool
        self.parameters = amounts(count)

    def travel_axes(self, target: str) -> frozenset[str]:
        return frozenset(state.axis for state in self.form.states if state.kind in MOTION)

    def possible_targets(self, job: Job) -> tuple[str, ...]:
        return (self.form.formula,)

    def displacement(self, path: Circumstances, target: str, **amount_um: float) -> Displaced:
        amounts = np.array([amount_um[p.name] for p in self.parameters])
        return self.form.direction.of_tool(1e-3 * self.form.at(path) @ amounts)


@cache
def amounts(count: int) -> tuple[Parameter, ...]:
    """The amplitudes of a form."""
    names = ["amount_um"] if count == 1 else [f"amount_{k + 1}_um" for k in range(count)]
    return tuple(linear(n, "displacement per unit of its states", usual=USUAL_UM) for n in names)
