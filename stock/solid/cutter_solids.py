"""Solids that strokes remove, united over a tree in space, each triangle with its move.

Source: the set operations are those of the library manifold3d.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from manifold3d import Manifold, OpType

from stock.solid.buried_strokes import Footprints
from stock.solid.level_cutters import level_groups, level_solid
from stock.solid.ring_stack import RingStack
from stock.solid.strokes import Strokes
from stock.solid.swept_hull import swept_points

__all__ = ["CutterSolids"]

#: strokes that are united in one go; more grow like n^1.5
LEAF_STROKES = 32
#: cylinders that stand for a round tool when strokes are looked at from above
_STEPS = 4


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
    _play_mm: np.ndarray = field(init=False)
    _needed_mm: np.ndarray = field(init=False)
    _open: np.ndarray = field(init=False)

    def __post_init__(self) -> None:
        s = self.strokes
        size = np.array([np.hypot(*stack.rings[:, :2].max(axis=0)) for stack in self.stacks])
        tilt = np.maximum(np.abs(s.start_tilt_rad), np.abs(s.end_tilt_rad)).max(axis=1)
        self._play_mm = 1e-6 + 2 * tilt * size[s.tool]
        self._needed_mm = self.top_mm - np.minimum(s.start_mm, s.end_mm)[:, 2] + self._play_mm
        # one path is open or closed at the top throughout, or its strokes would not fit together
        height = np.array([stack.rings[-1, 1] for stack in self.stacks])[s.tool]
        path = np.cumsum(~s.joined)
        self._open = ~np.isin(path, path[self._needed_mm > height])

    def boxes(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner, each (S, 3), of a box around every stroke."""
        s = self.strokes
        reach = np.array([stack.rings[:, 0].max() for stack in self.stacks])[s.tool]
        height = np.array([stack.rings[-1, 1] for stack in self.stacks])[s.tool]
        side, play = reach + self._play_mm, self._play_mm
        low = np.minimum(s.start_mm, s.end_mm) - np.column_stack([side, side, play])
        high = np.maximum(s.start_mm, s.end_mm) + np.column_stack([side, side, height + play])
        return low, high

    def footprints(self) -> Footprints:
        """What every stroke reaches and takes for sure, seen from above."""
        s, play = self.strokes, self._play_mm
        outer = np.array([stack.rings[:, 0].max() for stack in self.stacks])[s.tool]
        inner, height = np.moveaxis([_steps(stack) for stack in self.stacks], 2, 0)[:, s.tool]
        lowest = np.minimum(s.start_mm, s.end_mm)[:, 2]
        plunges = (s.start_mm[:, :2] == s.end_mm[:, :2]).all(axis=1)
        highest = np.where(plunges, lowest, np.maximum(s.start_mm, s.end_mm)[:, 2])
        return Footprints(
            start_mm=s.start_mm[:, :2],
            end_mm=s.end_mm[:, :2],
            outer_mm=outer + play,
            low_mm=lowest - play,
            inner_mm=np.where(self._open[:, None], inner - play[:, None], 0.0),
            floor_mm=(highest + play)[:, None] + height,
        )

    def union(self, index: np.ndarray, done: Callable[[int], None]) -> Manifold:
        """One solid of the strokes `index`, (S,); `done` is told how many are finished."""
        single = np.zeros(len(self.strokes), dtype=bool)
        single[index] = True
        solids = []
        for group in level_groups(self.strokes, self.stacks, index[self._open[index]]):
            stack = self.stacks[self.strokes.tool[group[0]]]
            top_mm = self.top_mm + stack.rings[0, 0]
            solid, move_of_id = level_solid(self.strokes, stack, group, top_mm=top_mm)
            self.move_of_id |= move_of_id
            solids.append(solid)
            single[group] = False
            done(len(group))
        if single.any():
            solids.append(self._halves(np.flatnonzero(single), done))
        return Manifold.batch_boolean(solids, OpType.Add)

    def _halves(self, index: np.ndarray, done: Callable[[int], None]) -> Manifold:
        """Union over a tree in space: what lies inside is dropped early on the way back."""
        if len(index) <= LEAF_STROKES:
            solid = Manifold.batch_boolean([self._solid(i) for i in index], OpType.Add)
            solid.num_tri()  # the library computes when asked
            done(len(index))
            return solid
        centre = (self.strokes.start_mm[index] + self.strokes.end_mm[index]) / 2
        order = np.argsort(centre[:, np.argmax(np.ptp(centre, axis=0))], kind="stable")
        half = len(order) // 2
        solid = self._halves(index[order[:half]], done) + self._halves(index[order[half:]], done)
        solid.num_tri()
        return solid

    def _solid(self, i: int) -> Manifold:
        s = self.strokes
        stack = self.stacks[s.tool[i]]
        if self._open[i]:
            stack = stack.up_to(self._needed_mm[i])
        placement = np.stack([s.start_mm[i], s.end_mm[i], s.start_tilt_rad[i], s.end_tilt_rad[i]])
        solid = Manifold.hull_points(
            swept_points(stack.rings, stack.azimuths, placement, s.before(i), s.ends(i))
        )
        self.move_of_id[solid.original_id()] = int(s.move[i])
        return solid


def _steps(stack: RingStack) -> np.ndarray:
    """Radius and lower end of cylinders within a faceted tool, (`_STEPS`, 2); 0 where none."""
    widest = int(np.argmax(stack.rings[:, 0]))
    k = np.unique(np.linspace(widest, 0, _STEPS).round().astype(np.int64))
    steps = np.zeros((_STEPS, 2))
    steps[: len(k), 0] = stack.rings[k, 0] * np.cos(np.pi / stack.azimuths[k])
    steps[: len(k), 1] = stack.rings[k, 1]
    return steps
