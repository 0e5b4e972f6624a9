"""An effect of a job: its target, its parameters, and how well they are known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vmach.effects.circumstances import Circumstances
from vmach.effects.effect import Displaced, Effect, at_contact, label_of
from vmach.errors import InputError
from vmach.job import Job
from vmach.machine import RigidDisplacement
from vmach.text_file import read_text
from vmach.toml_file import line_of_key
from vmach.toolpath import PathStates

__all__ = ["EffectInstance", "check_fitted", "one_sigma"]

#: share of a standard uncertainty by which parameters are moved, where laws are straight
_SHARE = 0.05


@dataclass(frozen=True)
class EffectInstance:
    """An effect with its target and all parameters set, as in ``[effects.NAME]`` of a job.

    `one_sigma` holds independent changes of the parameters, one standard uncertainty each.
    """

    effect: Effect
    target: str
    parameters: Mapping[str, float]
    job: Job
    one_sigma: Sequence[Mapping[str, float]] = ()

    @property
    def label(self) -> str:
        """Name and target."""
        return label_of(self.effect.name, self.target)

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

    def left_open(self, states: PathStates) -> np.ndarray:
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
        """The part that stays the same in all runs, one column a change, (P, 3, K) mm."""
        moved = np.zeros((len(path), 3, len(self.one_sigma)))
        if self.one_sigma and not self._is_out_of_sight(path):
            here = self._at(path, self.parameters)
            for k, change in enumerate(self.one_sigma):
                moved[:, :, k] = (self._at(path, self._towards(change)) - here) / _SHARE
        return moved

    def _is_out_of_sight(self, path: Circumstances) -> bool:
        """Whether it acts on surfaces, and there is none."""
        return self.effect.needs_surface and path.states.normal is None

    def _towards(self, change: Mapping[str, Any]) -> dict[str, Any]:
        """The parameters, moved by a small share of a change."""
        moved = {n: _SHARE * np.asarray(d) + self.parameters[n] for n, d in change.items()}
        return {**self.parameters, **moved}

    def _at(self, path: Circumstances, parameters: Mapping[str, float]) -> np.ndarray:
        return at_contact(self.effect.displacement(path, self.target, **parameters), path)

    def _evaluate(self, states: PathStates) -> Displaced:
        path = Circumstances(states, self.job)
        return self.effect.displacement(path, self.target, **self.parameters)


def one_sigma(
    effect: Effect, target: str, parameters: Mapping[str, Any], job: Job
) -> tuple[Mapping[str, Any], ...]:
    """What the job says of the uncertainty of an effect's parameters, checked against them.

    Raises
    ------
    InputError
        It is of parameters that the effect has not, or of more values.
    """
    changes = job.fitted.get((effect.name, target), ())
    for change in changes:
        for name, value in change.items():
            if np.shape(value) != np.shape(parameters.get(name, "")) or name not in parameters:
                raise InputError(
                    f"[[fitted]] of {effect.name} {target}: {name} does not match the effect",
                    file=job.path,
                    line=line_of_key(read_text(job.path, what="job file"), ["fitted"]),
                    accepted="parameters of the effect, as many values as it has",
                    hint="leave [[fitted]] as `vmach add` wrote it, or take it out",
                )
    return changes


def check_fitted(job: Job, found: Sequence[EffectInstance]) -> None:
    """Whether every [[fitted]] of a job belongs to one of its effects.

    Raises
    ------
    InputError
        It belongs to none.
    """
    for name, target in job.fitted.keys() - {(e.effect.name, e.target) for e in found}:
        raise InputError(
            f"[[fitted]] is of {label_of(name, target)}, an effect that the job has not",
            file=job.path,
            line=line_of_key(read_text(job.path, what="job file"), ["fitted"]),
            accepted=", ".join(e.label for e in found) or "no [[fitted]]",
            hint="take this [[fitted]] out with the effect that it belongs to",
        )
