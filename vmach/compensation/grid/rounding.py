"""Ends rounded together: of the grid points around every end, those that leave least.

Source: closed form derived here: what an end off the grid leaves across its moves, linear between
the ends.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

from stock.threads import cores_to_use
from vmach.compensation.aim.probes import ProbeSets
from vmach.compensation.grid.choice import Points, advance, best_points, traced_back
from vmach.compensation.grid.places import Grid, GridPlaces
from vmach.compensation.grid.stretch import Pieces, Stretch
from vmach.compensation.pieces.plan import Plan
from vmach.program_text import Rewriter, Target

__all__ = ["Rounding"]

#: grid points of every end that the best sequence is taken from
_POINTS = 24
#: ends whose points are compared at once
_AT_ONCE = 512


@dataclass(frozen=True)
class _Way:
    """What is known of the cheapest way to every point of K ends, in B blocks.

    Attributes
    ----------
    probes : ProbeSets
        That it is the cheapest for.
    came_from : (K, points) int8
        As in `advance`.
    total : (B + 1, points) float64
        Costs with which every block is begun, and with which the last one ends.
    kept : (I, points) int16
        Numbers of the points that inserted ends keep.
    """

    probes: ProbeSets
    came_from: np.ndarray
    total: np.ndarray
    kept: np.ndarray

    @classmethod
    def untrodden(cls, blocks: int, ends: int, inserted: int) -> _Way:
        """Room for it."""
        return cls(
            ProbeSets(()),
            np.zeros((ends, _POINTS), np.int8),
            np.zeros((blocks + 1, _POINTS)),
            np.zeros((inserted, _POINTS), np.int16),
        )


class Rounding:
    """Chooses the grid points of a target's ends.

    Rounding an end to the nearest point moves the tool by up to 0.9 steps. What counts is less:
    next to nothing along the path, and across it what is left at the probes. Along a straight
    move the error is linear between its ends; along an arc it is linear in radius, tangent and
    axis. Inserted ends may be written at other places of their move, where the grid comes nearer
    to the path.

    Of the points around every end those are kept that leave least between exact neighbours; the
    best sequence of these is found by dynamic programming.

    Parameters
    ----------
    rewriter : Rewriter
    plan : Plan
    target : Target
        With ends anywhere.
    resolution_mm : float
        Of the words X Y Z; in inch programs one decimal more.
    """

    def __init__(
        self, rewriter: Rewriter, plan: Plan, target: Target, resolution_mm: float
    ) -> None:
        self.rewriter, self.plan, self.target = rewriter, plan, target
        self.step_mm = _steps(rewriter, plan, resolution_mm)
        self.grid = Grid(rewriter, plan, target, self.step_mm)
        self.pieces = Pieces(self.grid)
        self.inserted = np.flatnonzero(self.grid.inserted)
        self._way: _Way | None = None

    def rounded(self, probes: ProbeSets) -> tuple[Plan, Target]:
        """Plan and target with ends on the grid, that leave least at some probes.

        Asked again with more sets beside the same ones, it goes only where these are, and on from
        there as far as the costs differ.

        Parameters
        ----------
        probes : ProbeSets
        """
        way, changed = self._way_so_far(probes)
        ahead, total = self._in_turn(probes, np.flatnonzero(changed)), np.zeros(_POINTS)
        for block in range(len(changed)):
            if not changed[block] and (total == way.total[block]).all():
                total = way.total[block + 1]
                continue
            stretch, number, points = next(ahead) if changed[block] else self._found(probes, block)
            own = slice(*np.searchsorted(self.inserted, self._bounds(block)))
            way.kept[own] = number[self.inserted[own] - stretch.begin]
            way.total[block] = total
            total = advance(stretch.course, stretch.exact, points, block * _AT_ONCE - stretch.begin,
                            total, way.came_from[stretch.begin:])  # fmt: skip
        way.total[-1] = total
        self._way = replace(way, probes=probes)
        number = traced_back(total, way.came_from)
        number[self.inserted] = way.kept[np.arange(len(self.inserted)), number[self.inserted]]
        return self._taken(number)

    def _way_so_far(self, probes: ProbeSets) -> tuple[_Way, np.ndarray]:
        """What is known of the way, and in which blocks there are probes beyond that."""
        ends, blocks = len(self.pieces), -(-len(self.pieces) // _AT_ONCE)
        if self._way is None or not probes.begin_with(self._way.probes):
            return _Way.untrodden(blocks, ends, len(self.inserted)), np.ones(blocks, bool)
        bounds = [self._bounds(block) for block in range(blocks)]
        keys = np.array([self.pieces.keys(begin, min(stop + 1, ends)) for begin, stop in bounds])
        first, stop = probes.keys_beyond(self._way.probes).searchsorted(keys.T)
        return self._way, first < stop

    def _bounds(self, block: int) -> tuple[int, int]:
        """First end of a block, which is the last one of the block before, and its stop."""
        first = block * _AT_ONCE
        return max(first - 1, 0), min(first + _AT_ONCE, len(self.pieces))

    def _found(self, probes: ProbeSets, block: int) -> tuple[Stretch, np.ndarray, Points]:
        """A block as a stretch, with the points that its ends keep: numbers, and they."""
        begin, stop = self._bounds(block)
        stretch = Stretch(self.pieces, probes, begin, min(stop + 1, len(self.pieces)))
        ends = np.arange(begin, stop)
        number, places = self._best(stretch, ends)
        return stretch, number, stretch.points(places, ends)

    def _in_turn(
        self, probes: ProbeSets, blocks: np.ndarray
    ) -> Iterator[tuple[Stretch, np.ndarray, Points]]:
        """Some blocks, (B,), one after the other, found on all cores.

        The points of all ends would fill the memory.
        """
        cores = cores_to_use()
        with ThreadPoolExecutor(cores) as pool:
            waiting: deque[Future[tuple[Stretch, np.ndarray, Points]]] = deque()
            for block in blocks.tolist():
                waiting.append(pool.submit(self._found, probes, block))
                if len(waiting) > cores:
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()

    def _near(self, ends: np.ndarray) -> Iterator[tuple[np.ndarray, GridPlaces]]:
        """All points about some ends, (E,): which of these, and their points."""
        inserted = self.grid.inserted[ends]
        for mask, near in (inserted, self.grid.of_inserted), (~inserted, self.grid.of_programmed):
            if mask.any():
                yield np.flatnonzero(mask), near(ends[mask])

    def _best(self, stretch: Stretch, ends: np.ndarray) -> tuple[np.ndarray, GridPlaces]:
        """The points that leave least between exact neighbours: numbers, (E, points), and they.

        A programmed end has no more points than are kept.
        """
        best, near = np.empty((len(ends), _POINTS), np.int64), [*self._near(ends)]
        best[:] = np.arange(_POINTS)
        for rows, places in near:
            if places.count > _POINTS:
                points, own = stretch.points(places, ends[rows]), ends[rows] - stretch.begin
                best[rows] = best_points(stretch.course, stretch.exact, points, own, _POINTS)
        return best, self._places(ends, near, best)

    def _places(
        self, ends: np.ndarray, near: Iterable[tuple[np.ndarray, GridPlaces]], number: np.ndarray
    ) -> GridPlaces:
        """Of all points about some ends those with these numbers, (E, C)."""
        found = GridPlaces.empty(len(ends), number.shape[1])
        for rows, places in near:
            kept = places if places.count == number.shape[1] else places.taken(number[rows])
            found.put(rows, kept)
        found.off_mm[self.plan.is_kept[ends]] = 0.0
        return found

    def _taken(self, number: np.ndarray) -> tuple[Plan, Target]:
        """Plan and target with the points of these numbers, (K,)."""
        chosen = GridPlaces.empty(len(number), 1)
        for first in range(0, len(number), _AT_ONCE):
            ends = np.arange(first, min(first + _AT_ONCE, len(number)))
            inserted = self.grid.inserted[ends]
            own, others = ends[inserted], ends[~inserted]
            if len(own):
                chosen.put(own, self.grid.of_inserted(own).taken(number[own, None]))
            chosen.put(others, self.grid.one_of_programmed(others, number[others]))
        chosen.off_mm[self.plan.is_kept] = 0.0
        plan, inserted = self.plan, np.flatnonzero(self.grid.inserted)
        if len(inserted):
            old = plan.pieces
            start, end = old.start.copy(), old.end.copy()
            end[inserted] = start[inserted + 1] = chosen.parameter[inserted, 0]
            plan = Plan(replace(old, start=start, end=end), plan.aim_mm)
        ends_mm = (chosen.wanted_mm + chosen.off_mm)[:, 0]
        return plan, Target(plan.pieces, ends_mm, self.target.middles_mm)


def _steps(rewriter: Rewriter, plan: Plan, resolution_mm: float) -> np.ndarray:
    """Step of the words of every piece, (K,) mm."""
    unit_mm = rewriter.modes.column("unit_mm", rewriter.moves.line[plan.move], other=1.0)
    units, which = np.unique(unit_mm, return_inverse=True)
    steps = [unit * 10.0 ** -rewriter.control.decimals(resolution_mm, unit)
             for unit in units.tolist()]  # fmt: skip
    return np.array(steps)[which]
