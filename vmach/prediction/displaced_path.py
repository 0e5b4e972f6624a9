"""The program's path displaced by machine and effects: as sweeps, whole or piece by piece.

Source: closed form derived here: the tip stands at nominal + e (docs/engine.md).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np

from stock import Material, Sweeps
from vmach.machine import Machine, RigidDisplacement, Variant, displacement, in_machine_axes
from vmach.path.preparation import Preparation
from vmach.path.toolpath import PathStates, Toolpath
from vmach.path.touched_zero import relative_to_zero
from vmach.prediction.sweeping import build_sweeps, join_sweeps

__all__ = [
    "ActingEffect",
    "DisplacedPath",
    "displaced_sweeps",
    "displacement_of",
    "of_machine",
]

#: pieces of the path that are displaced at a time: some MB each
PIECES_AT_ONCE = 10_000


class ActingEffect(Protocol):
    """An effect at work: its target and parameters are set, so that states are all it needs."""

    @property
    def label(self) -> str:
        """Name and target."""

    def displacement(self, states: PathStates) -> RigidDisplacement:
        """Rigid motion of the tool relative to the workpiece, whatever the surface."""

    def at_surface(self, states: PathStates) -> np.ndarray:
        """Further displacement of the cutting edge at the contact, (P, 3) mm."""

    def tool_shift(self, states: PathStates) -> np.ndarray:
        """The part of it that moves the whole tool, wherever it touches, (P, 3) mm."""

    def uncertainty_patterns(self, states: PathStates) -> np.ndarray:
        """Displacements at the contact, (P, 3, K) mm of unit variance, that are left open."""


def displaced_sweeps(
    preparation: Preparation, variant: Variant, effects: Sequence[ActingEffect] = ()
) -> Sweeps:
    """Sweeps of the whole program, displaced by the machine's errors and the effects."""
    path = preparation.path
    # effects look back along the path, and keep what they found for all of it
    parts = [path] if effects else path.parts(PIECES_AT_ONCE)
    sweeps = join_sweeps(
        parts,
        lambda nodes: displacement_of(preparation, nodes, variant, effects),
        count=len(path.first_node),
        zero_mm=preparation.zero_mm,
        tool_index=preparation.tool_index,
    )
    return _with_tools_shifted(sweeps, path, effects)


def _with_tools_shifted(sweeps: Sweeps, path: Toolpath, effects: Sequence[ActingEffect]) -> Sweeps:
    """Sweeps where the whole tool is shifted too: of several passes the deepest one counts.

    Straight between two nodes: a step within a piece swings over on neither side of it.
    """
    shift = sum((e.tool_shift(path.nodes) for e in effects), np.zeros((len(path.nodes), 3)))
    if not shift.any():
        return sweeps
    ends = np.stack([shift[path.first_node], shift[path.first_node + 1]], axis=1)
    return replace(
        sweeps,
        shift_mm=sweeps.shift_mm + ends,
        shift_slope_mm=sweeps.shift_slope_mm + np.diff(ends, axis=1),
    )


def displacement_of(
    preparation: Preparation, states: PathStates, variant: Variant, effects: Sequence[ActingEffect]
) -> RigidDisplacement:
    """Rigid displacement of the tool at P states, by the machine's errors and the effects.

    It counts from the workpiece zero as it was touched, where the job says how.
    """
    job = preparation.job
    return relative_to_zero(
        job, states, lambda some: of_machine(job.machine, some, variant, effects)
    )


def of_machine(
    machine: Machine, states: PathStates, variant: Variant, effects: Sequence[ActingEffect]
) -> RigidDisplacement:
    """The same as the machine makes it, whatever zero the job counts from; in its axes."""
    direction = states.direction if machine.separate_directions else None
    place = states.nose_mm, states.rotary_rad
    total = displacement(
        machine, place[0], states.tool_mm, variant, direction=direction, rotary_rad=place[1]
    )
    total = in_machine_axes(machine, total, *place)
    for effect in effects:
        total = total + effect.displacement(states)
    return total


@dataclass(frozen=True)
class DisplacedPath:
    """The displaced path, of which a long program's sweeps are never all there at once.

    Attributes
    ----------
    preparation : Preparation
    variant : Variant
    effects : tuple of ActingEffect
    known : Sweeps or None
        `displaced_sweeps` of the same, where they are there already.
    """

    preparation: Preparation
    variant: Variant
    effects: tuple[ActingEffect, ...] = ()
    known: Sweeps | None = None

    @cached_property
    def sweeps(self) -> Sweeps:
        """All of them."""
        if self.known is not None:
            return self.known
        return displaced_sweeps(self.preparation, self.variant, self.effects)

    def material(self) -> Material:
        """What the sweeps leave of the job's blank."""
        blank = self.preparation.job.blank
        return Material(
            self._parts() if self._is_made_again else self.sweeps,
            self.preparation.cutters,
            None if blank is None else (blank.min_mm, blank.max_mm),
            count=len(self.preparation.path.first_node),
        )

    def at(self, sweep: np.ndarray, parameter: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Shift (P, 3) mm and tilt (P, 3) rad of the sweeps (P,) at their parameters (P,)."""
        if not self._is_made_again:
            return self.sweeps.displacement_at(sweep, parameter)
        path, here = self.preparation.path.of_pieces(sweep)
        return self._of(path).displacement_at(here, parameter)

    @property
    def _is_made_again(self) -> bool:
        """Whether sweeps are made as they are asked for: effects need the whole path at once."""
        return not self.effects and self.known is None and "sweeps" not in vars(self)

    def _parts(self) -> Iterator[Sweeps]:
        return map(self._of, self.preparation.path.parts(PIECES_AT_ONCE))

    def _of(self, path: Toolpath) -> Sweeps:
        moved = displacement_of(self.preparation, path.nodes, self.variant, self.effects)
        zero, index = self.preparation.zero_mm, self.preparation.tool_index
        return build_sweeps(path, moved, zero_mm=zero, tool_index=index)
