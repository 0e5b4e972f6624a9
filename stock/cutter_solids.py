"""Solids that strokes remove, united over a tree in space, each triangle with its move."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from manifold3d import Manifold, OpType

from stock.ring_stack import RingStack
from stock.strokes import Strokes
from stock.swept_hull import swept_points

__all__ = ["CutterSolids"]

#: strokes that are united in one go; more grow like n^1.5
LEAF_STROKES = 32


@dataclass
class CutterSolids:
    """Makes the solids of strokes and remembers which move each of their triangles is from.

    Attributes
    ----------
    strokes : Strokes
    stacks : sequence of RingStack
        One a tool.
    top_mm : float
        No material lies higher; tools are left open above it.
    move_of_id : dict of int to int
        Move of each solid made so far, by the mesh identity that survives set operations.
    """

    strokes: Strokes
    stacks: Sequence[RingStack]
    top_mm: float
    move_of_id: dict[int, int] = field(default_factory=dict)

    def boxes(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner, each (S, 3), of a box around every stroke."""
        s = self.strokes
        reach = np.array([stack.rings[:, 0].max() for stack in self.stacks])[s.tool]
        height = np.array([stack.rings[-1, 1] for stack in self.stacks])[s.tool]
        tilt = np.maximum(np.abs(s.start_tilt_rad), np.abs(s.end_tilt_rad)).max(axis=1)
        play = 2 * tilt * (reach + height)
        side = reach + play
        low = np.minimum(s.start_mm, s.end_mm) - np.column_stack([side, side, play])
        high = np.maximum(s.start_mm, s.end_mm) + np.column_stack([side, side, height + play])
        return low, high

    def union(self, index: np.ndarray, done: Callable[[int], None]) -> Manifold:
        """One solid of the strokes `index`; `done` is told how many are finished.

        The strokes are halved in space down to a few, and the halves united on the way back, so
        that what lies inside is dropped early.
        """
        if len(index) <= LEAF_STROKES:
            solid = Manifold.batch_boolean([self._solid(i) for i in index], OpType.Add)
            solid.num_tri()  # the library computes when asked
            done(len(index))
            return solid
        centre = (self.strokes.start_mm[index] + self.strokes.end_mm[index]) / 2
        order = np.argsort(centre[:, np.argmax(np.ptp(centre, axis=0))], kind="stable")
        half = len(order) // 2
        solid = self.union(index[order[:half]], done) + self.union(index[order[half:]], done)
        solid.num_tri()
        return solid

    def _solid(self, i: int) -> Manifold:
        s = self.strokes
        lowest = min(s.start_mm[i, 2], s.end_mm[i, 2])
        tilt = max(np.abs(s.start_tilt_rad[i]).max(), np.abs(s.end_tilt_rad[i]).max())
        stack = self.stacks[s.tool[i]]
        above = 1e-6 + 2 * tilt * (stack.rings[:, 0].max() + stack.rings[-1, 1])
        stack = stack.up_to(self.top_mm - lowest + above)
        first = not s.joined[i]
        last = i + 1 == len(s) or not s.joined[i + 1]
        before = np.zeros(3) if first else s.end_mm[i - 1] - s.start_mm[i - 1]
        points = swept_points(
            stack.rings,
            stack.azimuths,
            np.stack([s.start_mm[i], s.end_mm[i], s.start_tilt_rad[i], s.end_tilt_rad[i]]),
            before,
            np.array([first, last]),
        )
        solid = Manifold.hull_points(points)
        self.move_of_id[solid.original_id()] = int(s.move[i])
        return solid
