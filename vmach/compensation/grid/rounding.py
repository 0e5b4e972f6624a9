"""Ends rounded together: of the grid points around every end, those that leave least.

Source: closed form derived here: what an end off the grid leaves across its moves, linear between
the ends.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from gcode import MoveKind
from vmach.compensation.aim.path_shift import arc_frames
from vmach.compensation.aim.probes import Probes
from vmach.compensation.grid.choice import Course, Points, advance, best_points, traced_back
from vmach.compensation.grid.places import Grid, GridPlaces
from vmach.compensation.pieces.plan import Plan
from vmach.path.geometry import position_at
from vmach.program_text import Rewriter, Target

__all__ = ["Rounding"]

#: grid points of every end that the best sequence is taken from
_POINTS = 24
#: ends whose points are compared at once
_AT_ONCE = 4096
#: probes whose steps are found at once
_PROBES_AT_ONCE = 1 << 18
#: weight of the eighth power beside the second, in steps: keeps the largest small
_LARGE = 16.0
#: weight of the whole distance of an end, and the way that a piece has at least for it
_STAYS, _LEAST_LENGTH_MM = 0.02, 0.1
#: weight of a step of an axis that stands in the user's program, and of one that is to stand
_A_STEP, _NO_STEP = 0.01, 1e4
#: an axis that moves by no more stands
_AT_REST_MM = 2e-7
_NO_SPAN = 1e-12


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
        self.is_arc = plan.pieces.is_arc
        self.first, self.last = plan.parameter(0.0), plan.parameter(1.0)
        feed = rewriter.moves.kind[plan.move] != MoveKind.RAPID
        self.path_length_mm = np.maximum(np.where(feed, self.grid.length_mm, 0.0), _LEAST_LENGTH_MM)

    def rounded(self, probes: Probes) -> tuple[Plan, Target]:
        """Plan and target with ends on the grid, that leave least at some probes.

        Parameters
        ----------
        probes : Probes
        """
        probes = probes.in_order()
        course, exact, count = self._course(probes), self.exact(probes), len(self.first)
        came_from = np.zeros((count, _POINTS), np.int8)
        kept = np.zeros((count, _POINTS), np.int16)
        total, last = np.zeros(_POINTS), None
        for first in range(0, count, _AT_ONCE):  # the points of all ends would fill the memory
            ends = np.arange(first, min(first + _AT_ONCE, count))
            kept[ends], places = self._best(course, exact, probes, ends)
            if last is not None:
                places, ends = last.before(places), np.arange(first - 1, ends[-1] + 1)
            points = self.points(probes, places, ends)
            total = advance(course, exact, points, int(ends[0]), first, total, came_from)
            last = places.last()
        choice = traced_back(total, came_from)
        return self._taken(kept[np.arange(count), choice].astype(np.int64))

    def _near(self, ends: np.ndarray) -> Iterator[tuple[np.ndarray, GridPlaces]]:
        """All points about some ends, (E,): which of these, and their points."""
        inserted = self.grid.inserted[ends]
        for mask, near in (inserted, self.grid.of_inserted), (~inserted, self.grid.of_programmed):
            if mask.any():
                yield np.flatnonzero(mask), near(ends[mask])

    def _best(
        self, course: Course, exact: Points, probes: Probes, ends: np.ndarray
    ) -> tuple[np.ndarray, GridPlaces]:
        """The points that leave least between exact neighbours: numbers, (E, points), and they."""
        best, near = np.zeros((len(ends), _POINTS), np.int64), [*self._near(ends)]
        for rows, places in near:
            points = self.points(probes, places, ends[rows])
            best[rows] = best_points(course, exact, points, ends[rows], _POINTS)
        return best, self._places(ends, near, best)

    def _places(
        self, ends: np.ndarray, near: Iterable[tuple[np.ndarray, GridPlaces]], number: np.ndarray
    ) -> GridPlaces:
        """Of all points about some ends those with these numbers, (E, C)."""
        found = GridPlaces.empty(len(ends), number.shape[1])
        for rows, places in near:
            found.put(rows, places.taken(number[rows]))
        found.off_mm[self.plan.is_kept[ends]] = 0.0
        return found

    def _taken(self, number: np.ndarray) -> tuple[Plan, Target]:
        """Plan and target with the points of these numbers, (K,)."""
        chosen = GridPlaces.empty(len(number), 1)
        for first in range(0, len(number), _AT_ONCE):
            ends = np.arange(first, min(first + _AT_ONCE, len(number)))
            chosen.put(ends, self._places(ends, self._near(ends), number[ends, None]))
        old, inserted = self.plan.pieces, np.flatnonzero(self.grid.inserted)
        start, end = old.start.copy(), old.end.copy()
        end[inserted] = start[inserted + 1] = chosen.parameter[inserted, 0]
        pieces = replace(old, start=start, end=end)
        ends_mm = (chosen.wanted_mm + chosen.off_mm)[:, 0]
        return Plan(pieces, self.plan.aim_mm), Target(pieces, ends_mm, self.target.middles_mm)

    def _course(self, probes: Probes) -> Course:
        """Probes in steps: what is left there by the corrections at both ends of their piece.

        On arcs only what the ends are off counts, in the frame of the place.
        """
        plan, first = self.plan, self.first
        inside = np.concatenate([[False], plan.move[1:] == plan.move[:-1]])
        normal, base = np.empty_like(probes.normal), np.empty_like(probes.left_mm)
        for begin in range(0, len(base), _PROBES_AT_ONCE):
            part = slice(begin, begin + _PROBES_AT_ONCE)
            normal[part], base[part] = self._in_steps(probes.part(part))
        return Course(
            normal=normal,
            base=base,
            weight=probes.path_length_mm,
            parameter=probes.parameter,
            only_below=probes.only_below,
            begin=np.where(inside, -1, np.searchsorted(probes.key, plan.move + first)),
            start=first,
            stays=_STAYS * self.path_length_mm / self.step_mm**2,
            still=self._still(),
            large=_LARGE,
        )

    def _in_steps(self, probes: Probes) -> tuple[np.ndarray, np.ndarray]:
        """Normals (P, 3), and what is left without corrections (P,), in steps: see `Course`."""
        first, span = self.first, np.maximum(self.last - self.first, _NO_SPAN)
        piece = np.searchsorted(self.plan.move + first, probes.key, side="right") - 1
        piece = np.maximum(piece, 0)
        share = (probes.parameter - first[piece]) / span[piece]
        end = self.target.ends_mm
        start = np.where((piece > 0)[:, None], end[piece - 1], 0.0)
        wanted = start + share[:, None] * (end[piece] - start)
        wanted[self.is_arc[piece]] = 0.0
        normal, arc = probes.normal.copy(), self.is_arc[piece]
        frames = arc_frames(self.rewriter.moves, probes.move[arc], probes.parameter[arc])
        normal[arc] = np.einsum("pvi,pi->pv", frames, probes.normal[arc])
        left = probes.left_mm - np.einsum("pi,pi->p", probes.normal, wanted)
        return normal / self.step_mm[piece][:, None], left / self.step_mm[piece]

    def _still(self) -> np.ndarray:
        """Weight against motion of axes that stand in a piece, and so need no word, (K, 3)."""
        moves, move, step = self.rewriter.moves, self.plan.move, self.step_mm[:, None]
        way = position_at(moves, move, self.last) - position_at(moves, move, self.first)
        stands = (np.abs(way) < _AT_REST_MM) & (self.rewriter.angle[move] == 0.0)[:, None]
        asked = np.abs(np.diff(self.target.ends_mm, axis=0, prepend=np.inf))
        weight = np.where(asked < 0.5 * step, _A_STEP * self.path_length_mm[:, None], 0.0)
        weight = np.where(asked < _AT_REST_MM, _NO_STEP, weight)
        return np.where(stands, weight / step**2, 0.0)

    def exact(self, probes: Probes) -> Points:
        """Ends without rounding, and a start in front of them."""
        count = len(self.first)
        here = GridPlaces(self.last[:, None], self.target.ends_mm[:, None], np.zeros((count, 1, 3)))
        points = self.points(probes, here, np.arange(count))
        return Points(*(np.concatenate([np.zeros_like(a[:1]), a]) for a in points))

    def points(self, probes: Probes, places: GridPlaces, ends: np.ndarray) -> Points:
        """What places of some ends, (K,), do to the pieces on both sides of them."""
        following = np.minimum(ends + 1, len(self.first) - 1)
        same = self.plan.move[following] == self.plan.move[ends]
        there = np.where(same[:, None], places.parameter, self.first[following][:, None])
        return Points(
            parameter=places.parameter,
            bound=np.searchsorted(probes.key, self.plan.move[ends][:, None] + places.parameter),
            at_end=self._in_frames(places, ends, places.parameter),
            at_start=self._in_frames(places, following, there),
            off=places.off_mm,
            corrected=places.wanted_mm + places.off_mm,
        )

    def _in_frames(
        self, places: GridPlaces, piece: np.ndarray, parameter: np.ndarray
    ) -> np.ndarray:
        """Corrections of lines; what is off on arcs, along radius, tangent and axis."""
        value = places.wanted_mm + places.off_mm
        arc = np.flatnonzero(self.is_arc[piece])
        move = np.repeat(self.plan.move[piece[arc]], parameter.shape[1])
        frames = arc_frames(self.rewriter.moves, move, parameter[arc].ravel())
        off = places.off_mm[arc]
        value[arc] = np.einsum("pvi,pi->pv", frames, off.reshape(-1, 3)).reshape(off.shape)
        return value


def _steps(rewriter: Rewriter, plan: Plan, resolution_mm: float) -> np.ndarray:
    """Step of the words of every piece, (K,) mm."""
    lines, of_line = np.unique(rewriter.moves.line[plan.move], return_inverse=True)
    units, which = np.unique([rewriter.modes[line].unit_mm for line in lines.tolist()],
                             return_inverse=True)  # fmt: skip
    steps = [unit * 10.0 ** -rewriter.control.decimals(resolution_mm, unit)
             for unit in units.tolist()]  # fmt: skip
    return np.array(steps)[which[of_line]]
