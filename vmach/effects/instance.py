"""An effect of a job: its target, its parameters, and how well they are known."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from vmach.effects.effect import Displaced, Effect, at_contact, label_of
from vmach.job import Job
from vmach.machine import RigidDisplacement
from vmach.path.circumstances import Circumstances
from vmach.path.toolpath import PathStates
from vmach.path.touched_zero import touched_zero

__all__ = ["EffectInstance"]

#: share of a standard uncertainty by which parameters are moved, where laws are straight
_SHARE = 0.05


@dataclass(frozen=True)
class EffectInstance:
    """An effect with its target and all parameters set, as in ``[effects.NAME]`` of a job.

    `one_sigma` holds independent changes of the parameters, one standard uncertainty each. Effects
    with the same number `together` share them: the k-th change of all of them is one. 0: alone.
    """

    effect: Effect
    target: str
    parameters: Mapping[str, float]
    job: Job
    one_sigma: Sequence[Mapping[str, float]] = ()
    together: int = 0

    @property
    def label(self) -> str:
        """Name and target."""
        return label_of(self.effect.name, self.target)

    @property
    def is_straight(self) -> bool:
        """Whether its displacement is proportional to all that is open of its parameters."""
        bent = {p.name for p in self.effect.parameters if not p.is_linear}
        return not any(bent & change.keys() for change in self.one_sigma)

    def displacement(self, states: PathStates) -> RigidDisplacement:
        """Rigid motion of the tool at the states; zero for effects bound to a surface."""
        if self.effect.needs_surface:
            return RigidDisplacement.zero(len(states))
        moved = self._evaluate(states)
        if isinstance(moved, RigidDisplacement):
            return moved
        return RigidDisplacement(moved, np.zeros_like(moved))

    def at_surface(self, states: PathStates) -> np.ndarray:
        """Displacement of the cutting edge, (P, 3) mm; zero for effects on the whole tool."""
        if not self.effect.needs_surface or states.normal is None:
            return np.zeros((len(states), 3))
        path = Circumstances(states, self.job)
        return at_contact(self._evaluate(states), path)

    def tool_shift(self, states: PathStates) -> np.ndarray:
        """The part of `at_surface` that moves the whole tool, wherever it touches, (P, 3) mm."""
        none = np.zeros((len(states), 3))
        if not self.effect.needs_surface:
            return none
        path = Circumstances(states, self.job)
        shift = self.effect.tool_shift(path, self.target, **self.parameters)
        return none if shift is None else shift

    def uncertainty_patterns(self, states: PathStates) -> np.ndarray:
        """Displacements at the contact, of unit variance, by which the truth may differ.

        What another run may do otherwise and what is not known of the parameters, (P, 3, K) mm.
        """
        path = Circumstances(states, self.job)
        return np.concatenate([self.unforeseen(path), self.of_parameters(path)], axis=2)

    def unforeseen(self, path: Circumstances) -> np.ndarray:
        """The part of what is left open that is new in every run, (P, 3, K) mm."""
        if self._is_out_of_sight(path):
            return np.zeros((len(path), 3, 0))
        return self.effect.unforeseen(path, self.target, self.parameters)

    def of_parameters(self, path: Circumstances) -> np.ndarray:
        """The part that stays the same in all runs, one column a change, (P, 3, K) mm.

        The slope of the law, as parameters make up for each other only along it. Where the law is
        bent, no more than what the whole change makes, to the side on which it makes more.
        """
        moved = np.zeros((len(path), 3, len(self.one_sigma)))
        if self.one_sigma and not self._is_out_of_sight(path):
            here = self.at(path, self.parameters)
            for k, change in enumerate(self.one_sigma):
                slope = (self.at(path, self._moved(change, _SHARE)) - here) / _SHARE
                if not self.is_straight:
                    up, down = (self.at(path, self._moved(change, by)) - here for by in (1.0, -1.0))
                    slope = _no_longer(slope, np.maximum(_length(up), _length(down)))
                moved[:, :, k] = slope
        return moved

    def at_parameters(self, path: Circumstances, drawn: Sequence[float]) -> np.ndarray:
        """Displacement at the contact where the parameters are elsewhere, (P, 3) mm.

        Parameters
        ----------
        path : Circumstances
        drawn : (K,) float
            How far along each change of `one_sigma`, in standard uncertainties.
        """
        if self._is_out_of_sight(path):
            return np.zeros((len(path), 3))
        return self.at(path, self._within_bounds(self.with_drawn(drawn).parameters))

    def with_drawn(self, drawn: Sequence[float]) -> EffectInstance:
        """The effect with its parameters moved along the changes of `one_sigma`, (K,) of them."""
        moved = dict(self.parameters)
        for amount, change in zip(drawn, self.one_sigma, strict=True):
            for name, by in change.items():
                moved[name] = (np.asarray(moved[name]) + amount * np.asarray(by)).tolist()
        return replace(self, parameters=moved)

    def _is_out_of_sight(self, path: Circumstances) -> bool:
        """Whether readings of this kind cannot show it."""
        return not self.effect.shows_on(path.states)

    def _moved(self, change: Mapping[str, Any], by: float) -> dict[str, Any]:
        """The parameters, moved by some of a change."""
        moved = {n: by * np.asarray(d) + self.parameters[n] for n, d in change.items()}
        return self._within_bounds({**self.parameters, **moved})

    def _within_bounds(self, parameters: Mapping[str, Any]) -> dict[str, Any]:
        """Parameters held where the effect has them: a way below zero makes no law."""
        held = dict(parameters)
        for one in self.effect.parameters:
            if one.name in held and not math.isfinite(one.cycle):
                held[one.name] = np.clip(held[one.name], one.low, one.high).tolist()
        return held

    def at(self, path: Circumstances, parameters: Mapping[str, Any]) -> np.ndarray:
        """Displacement at the contact with other parameters, (P, 3) mm.

        On a part it counts from the zero that was touched.
        """
        moved = at_contact(self.effect.displacement(path, self.target, **parameters), path)
        on_tool = path.states.normal is not None and not self.effect.needs_surface
        zero = touched_zero(path.job, path.states) if on_tool else None
        if zero is None:
            return moved
        there = Circumstances(zero.states, path.job, path.variant)
        at_touch = self.effect.displacement(there, self.target, **parameters)
        return moved - zero.shift_mm(at_contact(at_touch, there))

    def _evaluate(self, states: PathStates) -> Displaced:
        path = Circumstances(states, self.job)
        return self.effect.displacement(path, self.target, **self.parameters)


def _length(moved_mm: np.ndarray) -> np.ndarray:
    return np.linalg.norm(moved_mm, axis=1)


def _no_longer(moved_mm: np.ndarray, most_mm: np.ndarray) -> np.ndarray:
    """Displacements (P, 3), each cut to a length (P,)."""
    length = _length(moved_mm)
    share = np.divide(most_mm, length, out=np.ones_like(length), where=length > most_mm)
    return share[:, None] * moved_mm
