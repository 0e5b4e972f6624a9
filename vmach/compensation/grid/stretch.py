"""Some pieces of a program as the choice of grid points sees them, so that memory stays bounded.

Source: closed form derived here: what is left at a probe is linear between the ends of its piece.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from gcode import MoveKind
from vmach.compensation.aim.path_shift import arc_frames
from vmach.compensation.aim.probes import Probes, ProbeSets
from vmach.compensation.grid.choice import Course, Points
from vmach.compensation.grid.places import Grid, GridPlaces
from vmach.path.geometry import position_at

__all__ = ["Pieces", "Stretch"]

#: weight of the eighth power beside the second, in steps: keeps the largest small
_LARGE = 16.0
#: weight of the whole distance of an end, and the way that a piece has at least for it
_STAYS, _LEAST_LENGTH_MM = 0.02, 0.1
#: weight of a step of an axis that stands in the user's program, and of one that is to stand
_A_STEP, _NO_STEP = 0.01, 1e4
#: an axis that moves by no more stands
_AT_REST_MM = 2e-7
_NO_SPAN = 1e-12


class Pieces:
    """All K pieces of a plan with what is wanted at their ends.

    Parameters
    ----------
    grid : Grid
    """

    def __init__(self, grid: Grid) -> None:
        self.grid, self.rewriter, plan = grid, grid.rewriter, grid.plan
        self.target, self.step_mm = grid.target, grid.step_mm
        self.is_arc, self.move = plan.pieces.is_arc, plan.move
        self.first, self.last = plan.first, plan.last

    def __len__(self) -> int:
        return len(self.first)

    def key(self, own: slice) -> np.ndarray:
        """`Probes.key` of the starts of some pieces, (E,)."""
        return self.move[own] + self.first[own]

    def keys(self, begin: int, end: int) -> tuple[float, float]:
        """`Probes.key` of the start of one piece, and of the end of the piece before another."""
        is_last, last = end == len(self), end - 1
        stop = np.inf if is_last else float(self.move[last] + self.last[last])
        return float(self.move[begin] + self.first[begin]), stop

    def path_length_mm(self, own: slice) -> np.ndarray:
        """Lengths at feed of some pieces, (E,), at least `_LEAST_LENGTH_MM`."""
        feed = self.rewriter.moves.kind[self.move[own]] != MoveKind.RAPID
        length_mm = np.where(feed, self.grid.length_mm(own), 0.0)
        return np.maximum(length_mm, _LEAST_LENGTH_MM)


@dataclass
class Stretch:
    """Pieces from `begin` on up to `end`, and their probes, counted from the first of each.

    Attributes
    ----------
    pieces : Pieces
    along : ProbeSets
        Of all pieces.
    begin, end : int
        The points of ends before `end` can be compared.
    probes : Probes
        Of these pieces, along the path.
    course : Course
        Probes in steps: what is left there by the corrections at both ends of their piece. On
        arcs only what the ends are off counts, in the frame of the place.
    exact : Points
        Ends without rounding, with the one before the first in front.
    """

    pieces: Pieces
    along: ProbeSets
    begin: int
    end: int
    probes: Probes = field(init=False)
    course: Course = field(init=False)
    exact: Points = field(init=False)

    def __post_init__(self) -> None:
        self.probes = self.along.between(*self.pieces.keys(self.begin, self.end))
        self.course, self.exact = self._course(), self._exact()

    def _course(self) -> Course:
        pieces, own = self.pieces, slice(self.begin, self.end)
        move = pieces.move[own]
        inside = np.append(self.begin > 0 and pieces.move[self.begin - 1] == move[0],
                           move[1:] == move[:-1])  # fmt: skip
        normal, base = self._in_steps()
        step_mm, length_mm = pieces.step_mm[own], pieces.path_length_mm(own)
        return Course(
            normal=normal,
            base=base,
            weight=self.probes.path_length_mm,
            parameter=self.probes.parameter,
            only_below=self.probes.only_below,
            begin=np.where(inside, -1, np.searchsorted(self.probes.key, pieces.key(own))),
            start=pieces.first[own],
            stays=_STAYS * length_mm / step_mm**2,
            still=self._still(),
            large=_LARGE,
        )

    def _in_steps(self) -> tuple[np.ndarray, np.ndarray]:
        """Normals (P, 3), and what is left without corrections (P,), in steps: see `Course`."""
        pieces, probes = self.pieces, self.probes
        near = slice(self.begin, self.end)
        piece = np.searchsorted(pieces.key(near), probes.key, side="right") - 1 + self.begin
        piece = np.maximum(piece, 0)
        first, end = pieces.first, pieces.target.ends_mm
        span = np.maximum(pieces.last[piece] - first[piece], _NO_SPAN)
        share = (probes.parameter - first[piece]) / span
        start = np.where((piece > 0)[:, None], end[piece - 1], 0.0)
        wanted = start + share[:, None] * (end[piece] - start)
        wanted[pieces.is_arc[piece]] = 0.0
        normal, arc = probes.normal.copy(), pieces.is_arc[piece]
        frames = arc_frames(pieces.rewriter.moves, probes.move[arc], probes.parameter[arc])
        normal[arc] = np.einsum("pvi,pi->pv", frames, probes.normal[arc])
        left = probes.left_mm - np.einsum("pi,pi->p", probes.normal, wanted)
        return normal / pieces.step_mm[piece][:, None], left / pieces.step_mm[piece]

    def _still(self) -> np.ndarray:
        """Weight against motion of axes that stand in a piece, and so need no word, (K, 3)."""
        pieces, own = self.pieces, slice(self.begin, self.end)
        moves, move, step = pieces.rewriter.moves, pieces.move[own], pieces.step_mm[own, None]
        way = position_at(moves, move, pieces.last[own]) - position_at(
            moves, move, pieces.first[own]
        )
        stands = (np.abs(way) < _AT_REST_MM) & (pieces.rewriter.angle[move] == 0.0)[:, None]
        end_mm = pieces.target.ends_mm
        before = end_mm[self.begin - 1 : self.begin] if self.begin else np.full((1, 3), np.inf)
        asked = np.abs(np.diff(end_mm[own], axis=0, prepend=before))
        weight = np.where(asked < 0.5 * step, _A_STEP * pieces.path_length_mm(own)[:, None], 0.0)
        weight = np.where(asked < _AT_REST_MM, _NO_STEP, weight)
        return np.where(stands, weight / step**2, 0.0)

    def _exact(self) -> Points:
        ends = np.arange(max(self.begin - 1, 0), self.end)
        here = GridPlaces(self.pieces.last[ends, None], self.pieces.target.ends_mm[ends, None],
                          np.zeros((len(ends), 1, 3)))  # fmt: skip
        points = self.points(here, ends)
        if self.begin:
            return points
        return Points(*(np.concatenate([np.zeros_like(a[:1]), a]) for a in points))

    def points(self, places: GridPlaces, ends: np.ndarray) -> Points:
        """What places of some ends, (K,) of all pieces, do to the pieces on both sides of them."""
        pieces = self.pieces
        following = np.minimum(ends + 1, len(pieces) - 1)
        same = pieces.move[following] == pieces.move[ends]
        there = np.where(same[:, None], places.parameter, pieces.first[following][:, None])
        bound = np.empty(places.parameter.shape, np.int64)
        for rows, own in _by_places(places.parameter):
            bound[rows] = np.searchsorted(self.probes.key, pieces.move[ends[rows]][:, None] + own)
        return Points(
            parameter=places.parameter,
            bound=bound,
            at_end=self._in_frames(places, ends, places.parameter),
            at_start=self._in_frames(places, following, there),
            off=places.off_mm,
            corrected=places.wanted_mm + places.off_mm,
        )

    def _in_frames(
        self, places: GridPlaces, piece: np.ndarray, parameter: np.ndarray
    ) -> np.ndarray:
        """Corrections of lines; what is off on arcs, along radius, tangent and axis."""
        value, pieces = places.wanted_mm + places.off_mm, self.pieces
        arcs = np.flatnonzero(pieces.is_arc[piece])
        for rows, own in _by_places(parameter[arcs]):
            arc = arcs[rows]
            move = np.repeat(pieces.move[piece[arc]], own.shape[1])
            frames = arc_frames(pieces.rewriter.moves, move, own.ravel())
            frames = frames.reshape(*own.shape, 3, 3)
            value[arc] = (frames * places.off_mm[arc][:, :, None]).sum(axis=3)
        return value


def _by_places(parameter: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Ends whose points, (E, C), are at one place, and that place, (K, 1); then the others, (L, C).

    What follows from the place alone need not be found for every point.
    """
    several = (parameter != parameter[:, :1]).any(axis=1)
    for rows, width in (np.flatnonzero(~several), 1), (np.flatnonzero(several), None):
        if len(rows):
            yield rows, parameter[rows, :width]
