"""Shifts of the tool asked for beside its nominal path, such that arcs stay arcs.

Source: closed form derived here: linear shifts between knots; on arcs radial, tangential and
axial, so that arcs stay arcs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gcode import MoveKind, Moves
from vmach.compensation.pieces.arcs import LARGEST_SWEEP_RAD
from vmach.compensation.pieces.plan import Plan
from vmach.path.geometry import move_length_mm, position_at, tangent_at

__all__ = ["PathShift", "arc_frames", "no_shift"]

#: nominal ends and starts that are nearer than this are one place
_SAME_MM = 1e-6
_NO_KNOT = -1
_NO_LENGTH_MM = 1e-9


@dataclass(frozen=True)
class PathShift:
    """Shifts at knots of the nominal path and between them.

    On a line the shift goes linearly from one knot to the next. An arc has a third knot in the
    middle of every stretch. The arc through three shifted points has its radius changed, to
    first order, by A + B cos(phi) + C sin(phi); along axis and tangent the shift is linear.

    Attributes
    ----------
    moves : Moves
        The nominal ones.
    move : (S,) int64
        Of every stretch, increasing.
    start, end : (S,) float64
        Parameters of the move.
    is_arc : (S,) bool
    knot : (S, 3) int64
        Knots at start, middle and end; -1 for the middle of a line.
    free : (U, 3) bool
        Axes in which a knot may be shifted at all.
    value_mm : (U, 3) float64
        Shifts of the knots, machine axes.
    """

    moves: Moves
    move: np.ndarray
    start: np.ndarray
    end: np.ndarray
    is_arc: np.ndarray
    knot: np.ndarray
    free: np.ndarray
    value_mm: np.ndarray

    def with_values(self, value_mm: np.ndarray) -> PathShift:
        """The same knots with other shifts, (U, 3) mm; those that are not free stay 0."""
        return replace(self, value_mm=np.where(self.free, value_mm, 0.0))

    def at(self, move: np.ndarray, parameter: np.ndarray) -> np.ndarray:
        """Shift at P places of the nominal moves, (P, 3) mm; zero on moves without knots."""
        stretch, matrix = self.matrices(move, parameter)
        return np.einsum("pkij,pkj->pi", matrix, self.value_mm[self.knot[stretch]])

    def matrices(self, move: np.ndarray, parameter: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """How the shifts of the knots enter at P places.

        Returns
        -------
        (P,) int64
            Stretches.
        (P, 3, 3, 3) float64
            ``shift = sum over k of matrix[:, k] @ value_mm[knot[stretch, k]]``.
        """
        inside = np.minimum(parameter, 1.0 - 1e-9)
        stretch = np.searchsorted(self.move + self.start, move + inside, side="right") - 1
        stretch = np.maximum(stretch, 0)
        matrix = np.zeros((len(move), 3, 3, 3))
        share = (parameter - self.start[stretch]) / (self.end - self.start)[stretch]
        known = self.move[stretch] == move
        line = np.flatnonzero(known & ~self.is_arc[stretch])
        matrix[line, 0] = (1.0 - share[line])[:, None, None] * np.eye(3)
        matrix[line, 2] = share[line][:, None, None] * np.eye(3)
        arc = np.flatnonzero(known & self.is_arc[stretch])
        if len(arc):
            matrix[arc] = self._on_arcs(stretch[arc], parameter[arc], share[arc])
        return stretch, matrix

    @cached_property
    def length_mm(self) -> np.ndarray:
        """Length of every stretch, (S,)."""
        return (self.end - self.start) * move_length_mm(self.moves)[self.move]

    @cached_property
    def cuts(self) -> np.ndarray:
        """Stretches at feed, (S,) bool."""
        return self.moves.kind[self.move] != MoveKind.RAPID

    def tangents(self, parameter: np.ndarray) -> np.ndarray:
        """Unit tangents of the stretches' moves at parameters (S,), (S, 3); zero for no way."""
        tangent = tangent_at(self.moves, self.move, parameter)
        return tangent / np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), _NO_LENGTH_MM)

    @cached_property
    def frames(self) -> np.ndarray:
        """Radial, tangential and axial unit vectors at the knots of every arc, (S, 3, 3, 3).

        Indices are stretch, knot, vector, component; zero on lines.
        """
        found = np.zeros((len(self.move), 3, 3, 3))
        arc = np.flatnonzero(self.is_arc)
        for k, share in enumerate((0.0, 0.5, 1.0)):
            parameter = self.start[arc] + share * (self.end - self.start)[arc]
            found[arc, k] = arc_frames(self.moves, self.move[arc], parameter)
        return found

    def _on_arcs(self, stretch: np.ndarray, parameter: np.ndarray, share: np.ndarray) -> np.ndarray:
        half = 0.5 * np.abs(self.moves.sweep_rad[self.move] * (self.end - self.start))[stretch]
        phi = (2.0 * share - 1.0) * half
        even, odd = (np.sin(0.5 * phi) / np.sin(0.5 * half)) ** 2, np.sin(phi) / np.sin(half)
        linear = np.stack([1.0 - share, np.zeros_like(share), share], axis=1)
        radial = np.stack([0.5 * (even - odd), 1.0 - even, 0.5 * (even + odd)], axis=1)
        weight = np.stack([radial, linear, linear], axis=2)
        here = arc_frames(self.moves, self.move[stretch], parameter)
        return np.einsum("pkv,pvi,pkvj->pkij", weight, here, self.frames[stretch])


def no_shift(moves: Moves, plan: Plan, may_shift: np.ndarray) -> PathShift:
    """Knots at all ends of the plan's pieces, without shifts.

    Moves that meet share a knot, so that the tool's path stays in one piece. The start of the
    first piece, and of one after a move that is not rewritten, cannot be shifted; a program whose
    first move is taken to start where it ends has one knot for it.

    Parameters
    ----------
    moves : Moves
        The nominal ones.
    plan : Plan
    may_shift : (M, 3) bool
        Axes that may be shifted, for every nominal move.
    """
    builder = _Knots(moves, may_shift)
    for piece in plan.pieces:
        if not piece.is_step:
            is_arc = moves.kind[piece.move] == MoveKind.ARC and (piece.is_arc or piece.kept)
            builder.add(piece.move, piece.start, piece.end, bool(is_arc))
    move, start, end, is_arc, *knot = zip(*builder.stretches, strict=True)
    free = np.array(builder.free)
    return PathShift(
        moves,
        np.array(move, np.int64),
        np.array(start),
        np.array(end),
        np.array(is_arc),
        np.array(knot, np.int64).T,
        free,
        np.zeros(free.shape),
    )


class _Knots:
    """Goes along the pieces and numbers their ends."""

    def __init__(self, moves: Moves, may_shift: np.ndarray) -> None:
        self.moves, self.may_shift = moves, may_shift
        self.number = np.cumsum(moves.kind != MoveKind.DWELL)
        self.stretches: list[tuple] = []
        self.free: list[np.ndarray] = []

    def add(self, move: int, start: float, end: float, is_arc: bool) -> None:
        """One piece; an arc in stretches that three knots can hold."""
        way = self.moves.end_mm[move] - self.moves.start_mm[move]
        stands = not self.stretches and not is_arc and np.abs(way).max() < _SAME_MM
        sweep = abs(self.moves.sweep_rad[move]) * (end - start) if is_arc else 0.0
        count = max(int(np.ceil(sweep / LARGEST_SWEEP_RAD)), 1)
        places = np.linspace(start, end, count + 1)
        first = self._start(move, start, stands)
        for begin, stop in zip(places[:-1].tolist(), places[1:].tolist(), strict=True):
            middle = self._new(self.may_shift[move]) if is_arc else _NO_KNOT
            last = first if stands else self._new(self.may_shift[move])
            self.stretches.append((move, begin, stop, is_arc, first, middle, last))
            first = last

    def _start(self, move: int, start: float, stands: bool) -> int:
        """The knot that the last stretch ends in, where it leads there."""
        if self.stretches:
            last, _, end, *_, knot = self.stretches[-1]
            if last == move:
                return knot
            meets = end == 1.0 and start == 0.0 and self.number[move] == self.number[last] + 1
            gap = self.moves.start_mm[move] - self.moves.end_mm[last]
            if meets and np.abs(gap).max() < _SAME_MM:
                return knot
        return self._new(self.may_shift[move] & stands)

    def _new(self, free: np.ndarray) -> int:
        self.free.append(free)
        return len(self.free) - 1


def arc_frames(moves: Moves, move: np.ndarray, parameter: np.ndarray) -> np.ndarray:
    """Radial, tangential and axial unit vectors on arcs, (P, 3 vectors, 3)."""
    axis = moves.axis[move]
    out = position_at(moves, move, parameter) - moves.centre_mm[move]
    out = out - np.einsum("ij,ij->i", out, axis)[:, None] * axis
    out = out / np.linalg.norm(out, axis=1, keepdims=True)
    return np.stack([out, np.cross(axis, out), axis], axis=1)
