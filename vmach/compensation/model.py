"""The error of the tool tip that a program is compensated for.

Source: the equations of `vmach.machine.displacement` and the effects of the job.
"""

from __future__ import annotations

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
        return self.displacement_at(preparation, move, parameter).shift_mm

    def displacement_at(
        self, preparation: Preparation, move: np.ndarray, parameter: np.ndarray
    ) -> RigidDisplacement:
        """Shift of the tip and tilt of the tool at places of moves, both (P,)."""
        nodes = preparation.path.nodes
        shift, tilt = np.zeros((len(move), 3)), np.zeros((len(move), 3))
        tool = np.minimum(nodes.moves.tool[move], len(nodes.tool_lengths_mm) - 1)
        every = np.flatnonzero((tool > 0) & np.isfinite(nodes.tool_lengths_mm[tool]))
        at_once = len(every) if self.effects else max(_AT_ONCE, len(nodes.moves))
        for first in range(0, len(every), max(at_once, 1)):
            held = every[first : first + at_once]
            states = PathStates(nodes.moves, nodes.tool_lengths_mm, move[held], parameter[held],
                                np.zeros((len(held), 3)))  # fmt: skip
            found = displacement_of(preparation, states, self.variant, self.effects)
            shift[held], tilt[held] = found.shift_mm, found.tilt_rad
        return RigidDisplacement(shift, tilt)

    def is_none(self, preparation: Preparation) -> bool:
        """Whether the tool is where it should be all along the program."""
        nodes = preparation.path.nodes
        error = self.error_at(preparation, nodes.move, nodes.parameter)
        return not (np.abs(error) > _NOTHING_MM).any()
