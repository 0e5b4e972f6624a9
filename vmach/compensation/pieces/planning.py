"""Where points are inserted: as few as hold the tool within the tolerance.

Source: closed form derived here: a bow of sagitta d needs sqrt(d / 2w) chords in a tube of half
width w.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from gcode import MoveKind, Moves
from vmach.compensation.pieces.arcs import LARGEST_SWEEP_RAD, circle_misses, split_arc
from vmach.compensation.pieces.plan import Plan
from vmach.compensation.pieces.reversals import (
    is_taken_up,
    reversals_of_arcs,
    settled,
    turned_at_start,
)
from vmach.compensation.pieces.sampling import ErrorAlongMoves, ErrorAt
from vmach.compensation.pieces.tube import fewest_pieces
from vmach.path.geometry import across, move_length_mm, position_at, tangent_at
from vmach.program_text import Piece, Pieces

__all__ = ["plan_pieces"]

#: an error smaller than this is none
_NOTHING_MM = 1e-9
#: parameters that are nearer than this are one place
_ASIDE = 1e-5
#: share of the tolerance by which a corner may be off, across either of its two moves
_AT_CORNERS = np.sqrt(0.5)
#: sides of the rectangular tubes that are tried inside the round one, over its radius
_RECTANGLES = (0.7, 0.95, 0.3, 0.99, 0.1)
_BOTH_WAYS = np.array([[-1.0], [1.0]])
#: arcs whose samples are looked at in one go
_ARCS_AT_ONCE = 4096
#: sine of a turn that counts as a corner
_CORNER = 1e-3


def plan_pieces(
    moves: Moves, found: ErrorAlongMoves, error_at: ErrorAt, *, tolerance_mm: np.ndarray,
    rewritten: np.ndarray, unknown_start: np.ndarray,
) -> Plan:  # fmt: skip
    """Cut every move into the pieces that its error asks for.

    What counts is the distance across the path: a shift along it between two programmed points
    only changes when the tool is where. Vertices lie off the corrected curve, inside the
    tolerance, where that saves pieces; so do the ends of moves, by no more than 0.7 of the
    tolerance across either move.

    Parameters
    ----------
    moves : Moves
    found : ErrorAlongMoves
        Error of the moves that may be rewritten.
    error_at : callable
        Error of the tool, (P, 3) mm, at moves (P,) and parameters (P,).
    tolerance_mm : (M,) float64
        For every move.
    rewritten : (M,) bool
        Moves whose blocks cannot stay, see `Rewriter`.
    unknown_start : (M,) bool
        Moves that begin where the program does not say: they get no points.
    """
    return _Planner(moves, found, error_at, tolerance_mm, rewritten, unknown_start).plan()


@dataclass
class _Planner:
    """Plans all moves that are one piece at once, and goes through the others."""

    moves: Moves
    found: ErrorAlongMoves
    error_at: ErrorAt
    tolerance_mm: np.ndarray
    rewritten: np.ndarray
    unknown_start: np.ndarray
    #: pieces and aims of the moves that are not one piece alone
    own: dict[int, tuple[list[Piece], list[np.ndarray]]] = field(default_factory=dict)
    #: aims of the ends of other moves that have been shifted
    shifted: dict[int, np.ndarray] = field(default_factory=dict)

    def __post_init__(self) -> None:
        found, kind = self.found, self.moves.kind[self.found.move]
        straight = (kind == MoveKind.LINE) & (found.length_mm > 0) & ~self.unknown_start
        self.is_whole = self.unknown_start | (kind == MoveKind.RAPID) | (found.length_mm == 0)
        self.length_mm = move_length_mm(self.moves)
        self.is_bent = straight & (found.off_chord_mm() > self.tolerance_mm)
        self.size = found.largest_mm()
        start = np.zeros(len(found.move))
        tangent = tangent_at(self.moves, found.move, start)
        length = np.linalg.norm(tangent, axis=1, keepdims=True)
        self.direction = tangent / np.maximum(length, _NOTHING_MM)
        turned = turned_at_start(self.moves, found.move)
        start = np.zeros(len(found.move))
        self.settled, self.settled_error = self._settled(
            found.move, start, turned, self.tolerance_mm
        )
        self.turns = self._turns_of_arcs(np.flatnonzero(kind == MoveKind.ARC))
        self.in_tube = self.is_bent.copy()  # moves that may begin off the corrected curve
        self.in_tube[1:] |= straight[1:] & self.is_bent[:-1]

    def plan(self) -> Plan:
        """The plan of all moves."""
        found, kind = self.found, self.moves.kind[self.found.move]
        before = np.zeros((len(found.move), 3))
        before[1:] = found.error_mm[found.first[1:-1] - 1]
        nothing = np.maximum(self.size, np.abs(before).max(axis=1, initial=0.0)) < _NOTHING_MM
        kept = nothing & ~self.rewritten
        whole = ~kept & self.is_whole
        jump = across(self.settled_error - before, self.direction)
        self.steps = np.linalg.norm(jump, axis=1) > self.tolerance_mm
        is_arc = kind == MoveKind.ARC
        open_ = ~kept & ~whole & ~self.steps
        one_arc = open_ & is_arc
        one_arc[is_arc] &= self._is_one_arc(np.flatnonzero(is_arc))
        single = kept | whole | one_arc | (open_ & ~is_arc & ~self.in_tube)
        for index in np.flatnonzero(~single).tolist():
            self._add(index)
        return self._joined(kept, (whole & is_arc) | one_arc)

    def _joined(self, kept: np.ndarray, is_arc: np.ndarray) -> Plan:
        """All pieces in order, given which single ones are kept and arcs."""
        count = np.ones(len(kept), np.int64)
        order = list(self.own)
        count[order] = [len(self.own[index][0]) for index in order]
        first = np.cumsum(count) - count
        owner = np.repeat(np.arange(len(kept)), count)
        zeros = np.zeros(len(owner))
        pieces = Pieces(self.found.move[owner], zeros.copy(), np.ones(len(owner)), is_arc[owner],
                        kept[owner], zeros)  # fmt: skip
        aim = np.zeros((len(owner), 3))
        if order:
            rows = np.concatenate([first[k] + np.arange(count[k]) for k in order])
            own = Pieces.of(piece for k in order for piece in self.own[k][0])
            for name, column in vars(own).items():
                getattr(pieces, name)[rows] = column
            aim[rows] = np.array([value for k in order for value in self.own[k][1]])
        if self.shifted:
            aim[first[list(self.shifted)]] = list(self.shifted.values())
        return Plan(pieces, aim)

    def _add(self, index: int) -> None:
        """Plan the pieces of one move."""
        self.own[index] = [], []
        move = int(self.found.move[index])
        parameter, error = self.found.of(index)
        if self.steps[index]:
            self._put(index, Piece(move, 0.0, 0.0, settled=float(self.settled[index])))
            unsettled = (parameter < self.settled[index])[:, None]
            error = np.where(unsettled, self.settled_error[index], error)
        if self.moves.kind[move] == MoveKind.ARC:
            self._arc(index, error)
        elif self.in_tube[index]:
            self._tube(index, error)
        else:
            self._put(index, Piece(move, 0.0, 1.0))

    def _settled(
        self, move: np.ndarray, place: np.ndarray, turned: np.ndarray, tolerance_mm: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Where the error after reversals is there in full, (P,), and that error, (P, 3).

        What changes with the place as well, as lag does on a small circle, is told from lost
        motion by how it changed on as long a way before.
        """
        length = self.length_mm[move]
        soon = settled(self.moves, move, place, np.zeros_like(turned), length_mm=length)
        later = settled(self.moves, move, place, turned, length_mm=length)
        trend = self._trend(move, place, later - place)
        at_once, in_full = self.error_at(move, soon), self.error_at(move, later) - trend
        halfway = self.error_at(move, 0.5 * (place + later)) - 0.5 * trend
        farther = self.error_at(move, np.minimum(2.0 * later - place, 1.0)) - 2.0 * trend
        grows = is_taken_up(at_once, halfway, in_full, farther, least_mm=3.0 * tolerance_mm)
        return np.where(grows, later, soon), np.where(grows[:, None], in_full, at_once)

    def _trend(self, move: np.ndarray, place: np.ndarray, way: np.ndarray) -> np.ndarray:
        """How much the error changed on a way before places, (P, 3); 0 where moves begin."""
        trend = np.zeros((len(move), 3))
        rows = np.flatnonzero(place > way)
        if rows.size:
            move, place, way = move[rows], place[rows] - _ASIDE, way[rows] - _ASIDE
            trend[rows] = self.error_at(move, place) - self.error_at(move, place - way)
        return trend

    def _turns_of_arcs(self, arcs: np.ndarray) -> _Turns:
        """Where axes turn back on arcs, where the error is there in full, and after and before.

        Asked for all arcs at once: one question takes as long as thousands.
        """
        arc, place, axes = reversals_of_arcs(self.moves, self.found.move[arcs])
        owner = arcs[arc]
        row = self.found.move[owner]
        later, after = self._settled(row, place, axes, self.tolerance_mm[owner])
        before = self.error_at(row, place - _ASIDE)
        jump = across(after - before, tangent_at(self.moves, row, place))
        jumps = np.flatnonzero(np.linalg.norm(jump, axis=1) > self.tolerance_mm[owner])
        return _Turns(owner[jumps], place[jumps], later[jumps], after[jumps], before[jumps])

    def _is_one_arc(self, arcs: np.ndarray) -> np.ndarray:
        """Arcs that no jump divides and that one arc does for, (A,) bool."""
        sweep = np.abs(self.moves.sweep_rad[self.found.move[arcs]])
        fits = ~np.isin(arcs, self.turns.owner) & (sweep <= LARGEST_SWEEP_RAD)
        rows = np.flatnonzero(fits)
        for begin in range(0, len(rows), _ARCS_AT_ONCE):
            part = rows[begin : begin + _ARCS_AT_ONCE]
            fits[part] = self._circle_misses(arcs[part]) <= self.tolerance_mm[arcs[part]]
        return fits

    def _circle_misses(self, arcs: np.ndarray) -> np.ndarray:
        """How far corrected arcs (A,) are from arcs, mm."""
        found, moves = self.found, self.moves
        count = np.diff(found.first)[arcs]
        begin = np.cumsum(count) - count
        sample = np.arange(count.sum()) + np.repeat(found.first[arcs] - begin, count)
        move = np.repeat(found.move[arcs], count)
        parameter = found.parameter[sample]
        points = position_at(moves, move, parameter) - found.error_mm[sample]
        return circle_misses(points, parameter, np.append(begin, len(sample)),
                             moves.axis[found.move[arcs]])  # fmt: skip

    def _put(self, index: int, piece: Piece, aim_mm: np.ndarray | None = None) -> None:
        pieces, aims = self.own[index]
        pieces.append(piece)
        aims.append(np.zeros(3) if aim_mm is None else aim_mm)

    def _arc(self, index: int, error: np.ndarray) -> None:
        """Arcs between the places where an axis turns back and the error jumps."""
        move, parameter = int(self.found.move[index]), self.found.of(index)[0]
        jumps = self.turns.of(index)
        cuts = [0.0, *jumps.place, 1.0]
        for number, (start, end) in enumerate(pairwise(cuts)):
            ready = jumps.later[number - 1] if number else start
            inside = (parameter > ready + _ASIDE) & (parameter < end - _ASIDE)
            first = jumps.after[number - 1] if number else error[0]
            last = error[-1] if number == len(jumps.place) else jumps.before[number]
            if number:
                self._put(index, Piece(move, float(start), float(start), settled=float(ready)))
            places_here = np.concatenate([[start], parameter[inside], [end]])
            errors_here = np.vstack([first, error[inside], last])
            for piece in split_arc(self.moves, move, places_here, -errors_here,
                                   tolerance_mm=self.tolerance_mm[index]):  # fmt: skip
                self._put(index, piece)

    def _tube(self, index: int, error: np.ndarray) -> None:
        """A line whose error bends, as a polyline inside the tolerance."""
        parameter = self.found.of(index)[0]
        frame, start, end = self._ends(index)
        curve = -error @ frame.T
        vertex, off = min(
            (
                fewest_pieces(parameter, curve, width, start=_inside(start, width),
                              end=_BOTH_WAYS * end * width)
                for width in _widths(self.tolerance_mm[index], start)
            ),
            key=lambda polyline: len(polyline[0]),
        )  # fmt: skip
        move = int(self.found.move[index])
        if index:
            self._shift_corner(index, frame, off[0])
        for piece in range(len(vertex) - 1):
            first, last = parameter[vertex[piece]], parameter[vertex[piece + 1]]
            self._put(index, Piece(move, float(first), float(last)), off[piece + 1] @ frame)

    def _ends(self, index: int) -> tuple[np.ndarray, np.ndarray, float]:
        """Two directions across the move; range of its start along them; share of the width at
        its end.

        The end of the move before may still be shifted along that move's own direction, which
        is the first of the two directions as far as the corner turns.
        """
        own, before = self.direction[index], self._direction_before(index)
        side = across(before, own)
        turn = float(np.linalg.norm(side))
        if turn < _CORNER:
            side = across(np.eye(3)[np.argmin(np.abs(own))], own)
        side = side / np.linalg.norm(side)
        frame = np.stack([side, np.cross(own, side)])
        carried = self._aim_before(index)
        reach = _AT_CORNERS * self.tolerance_mm[index] * (turn if turn >= _CORNER else 0.0)
        slack = np.array([reach, 0.0])
        value = frame @ carried
        follows = index + 1 < len(self.in_tube) and self.in_tube[index + 1]
        return frame, np.stack([value - slack, value + slack]), _AT_CORNERS if follows else 0.0

    def _direction_before(self, index: int) -> np.ndarray:
        """Direction along which the start may be shifted; zero for none."""
        if index == 0 or self.own[index][0]:  # a step between them
            return np.zeros(3)
        kind = self.moves.kind[self.found.move[index - 1]]
        return self.direction[index - 1] if kind == MoveKind.LINE else np.zeros(3)

    def _shift_corner(self, index: int, frame: np.ndarray, off: np.ndarray) -> None:
        """Shift the end of the move before along its own direction to where this one begins."""
        before = self._direction_before(index)
        turn = float(frame[0] @ before)
        if turn >= _CORNER:
            aim = self._aim_before(index)
            aim = aim + (off[0] - frame[0] @ aim) / turn * before
            if index - 1 in self.own:
                self.own[index - 1][1][-1] = aim
            else:
                self.shifted[index - 1] = aim

    def _aim_before(self, index: int) -> np.ndarray:
        """Where the last piece before a move, or before its tube, shall lead, (3,) mm."""
        if self.own[index][1]:
            return self.own[index][1][-1]
        if index - 1 in self.own:
            return self.own[index - 1][1][-1]
        return self.shifted.get(index - 1, np.zeros(3))


@dataclass(frozen=True)
class _Turns:
    """Places on arcs where an axis turns back and the error jumps, in order; J of them.

    Attributes
    ----------
    owner : (J,) int64
        Index of the move.
    place, later : (J,) float64
        Parameter, and that from which on the error is there in full.
    after, before : (J, 3) float64
        Error there in full, and just before, mm.
    """

    owner: np.ndarray
    place: np.ndarray
    later: np.ndarray
    after: np.ndarray
    before: np.ndarray

    def of(self, index: int) -> _Turns:
        """Those of one move."""
        part = slice(*np.searchsorted(self.owner, [index, index + 1]))
        return _Turns(*(column[part] for column in vars(self).values()))


def _widths(tolerance_mm: float, start: np.ndarray) -> Iterator[np.ndarray]:
    """Half sides (2,) of rectangles inside the circle of the tolerance, wide enough to begin in."""
    fixed = abs(start[:, 1]).max()
    for share in _RECTANGLES:
        second = max(share * tolerance_mm, fixed)
        yield np.array([np.sqrt(max(tolerance_mm**2 - second**2, _NOTHING_MM**2)), second])


def _inside(start: np.ndarray, width: np.ndarray) -> np.ndarray:
    return np.clip(start, -width, width)
