"""Ends rounded together: of the grid points around every end, those that leave least.

Source: closed form derived here: what an end off the grid leaves across its moves, linear between
the ends.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace

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

    def rounded(self, probes: ProbeSets) -> tuple[Plan, Target]:
        """Plan and target with ends on the grid, that leave least at some probes.

        Parameters
        ----------
        probes : ProbeSets
        """
        count = len(self.pieces)
        came_from = np.zeros((count, _POINTS), np.int8)
        kept = np.zeros((count, _POINTS), np.int16)
        total = np.zeros(_POINTS)
        for first, (stretch, number, points) in zip(
            range(0, count, _AT_ONCE), self._candidates(probes), strict=True
        ):  # fmt: skip
            begin = stretch.begin
            kept[begin : begin + len(number)] = number
            total = advance(stretch.course, stretch.exact, points, first - begin, total,
                            came_from[begin:])  # fmt: skip
        choice = traced_back(total, came_from)
        return self._taken(kept[np.arange(count), choice].astype(np.int64))

    def _candidates(self, probes: ProbeSets) -> Iterator[tuple[Stretch, np.ndarray, Points]]:
        """Stretch after stretch with the points that its ends keep, found on all cores.

        Each begins with the last end of the one before. The points of all ends would fill the
        memory.
        """
        count, cores = len(self.pieces), cores_to_use()

        def found(first: int) -> tuple[Stretch, np.ndarray, Points]:
            begin, stop = max(first - 1, 0), min(first + _AT_ONCE, count)
            stretch = Stretch(self.pieces, probes, begin, min(stop + 1, count))
            ends = np.arange(begin, stop)
            number, places = self._best(stretch, ends)
            return stretch, number, stretch.points(places, ends)

        with ThreadPoolExecutor(cores) as pool:
            waiting: deque[Future[tuple[Stretch, np.ndarray, Points]]] = deque()
            for first in range(0, count, _AT_ONCE):
                waiting.append(pool.submit(found, first))
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
