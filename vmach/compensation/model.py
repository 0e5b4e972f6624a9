"""The error of the tool tip that a program is compensated for.

Source: the equations of `vmach.machine.displacement` and the effects of the job.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vmach.machine import RigidDisplacement, Variant
from vmach.path.preparation import Preparation
from vmach.path.toolpath import PathStates
from vmach.prediction import ActingEffect, displacement_of

__all__ = ["TipModel"]

#: places whose displacement is found at once, or as many as there are moves: directions are looked
#: for along all of them each time. What effects remember is asked for in one go
_AT_ONCE = 1 << 18
_NOTHING_MM = 1e-9


@dataclass(frozen=True)
class TipModel:
    """Error tables and effects of a job under one variant."""

    variant: Variant
    effects: tuple[ActingEffect, ...]

    def error_at(
        self, preparation: Preparation, move: np.ndarray, parameter: np.ndarray
    ) -> np.ndarray:
        """Shift of the tool tip, (P, 3) mm; zero where no tool of the job is in the spindle."""
        shift = np.zeros((len(move), 3))
        for rows, moved in self._displaced(preparation, move, parameter):
            shift[rows] = moved.shift_mm
        return shift

    def displacement_at(
        self, preparation: Preparation, move: np.ndarray, parameter: np.ndarray
    ) -> RigidDisplacement:
        """Shift of the tip and tilt of the tool at places of moves, both (P,)."""
        shift, tilt = np.zeros((len(move), 3)), np.zeros((len(move), 3))
        for rows, moved in self._displaced(preparation, move, parameter):
            shift[rows], tilt[rows] = moved.shift_mm, moved.tilt_rad
        return RigidDisplacement(shift, tilt)

    def _displaced(
        self, preparation: Preparation, move: np.ndarray, parameter: np.ndarray
    ) -> Iterator[tuple[np.ndarray, RigidDisplacement]]:
        """Places with a tool of the job, some at a time, and how it is displaced there."""
        nodes = preparation.path.nodes
        has_length = np.isfinite(nodes.tool_lengths_mm)
        has_length[0] = False
        at_once = len(move) if self.effects else max(_AT_ONCE, len(nodes.moves))
        for first in range(0, len(move), max(at_once, 1)):
            tool = nodes.moves.tool[move[first : first + at_once]]
            rows = first + np.flatnonzero(has_length[np.clip(tool, 0, len(has_length) - 1)])
            states = PathStates(nodes.moves, nodes.tool_lengths_mm, move[rows], parameter[rows],
                                np.zeros((len(rows), 3)))  # fmt: skip
            yield rows, displacement_of(preparation, states, self.variant, self.effects)

    def is_none(self, preparation: Preparation) -> bool:
        """Whether the tool is where it should be all along the program."""
        nodes = preparation.path.nodes
        error = self.error_at(preparation, nodes.move, nodes.parameter)
        return not (np.abs(error) > _NOTHING_MM).any()
