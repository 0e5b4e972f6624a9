"""A corner between two lines or arcs of a plane, rounded or chamfered.

Source: HEIDENHAIN, TNC 640 User's Manual for Klartext Programming (RND, CHF); closed forms are
derived here. An arc of radius r in a corner of angle a between lines touches both at r / tan(a / 2)
from it.
The centre of any rounding lies on the curves beside both pieces at the distance r, on the inner
side of the corner.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from gcode.errors import ProgramError
from gcode.geometry.arcs import Point

__all__ = ["Corner", "Piece", "broken_corner"]

_STRAIGHT = 1e-9


@dataclass(frozen=True)
class Piece:
    """A line, or an arc about `centre`: counter-clockwise for sense 1, clockwise for -1."""

    start: Point
    end: Point
    centre: Point | None = None
    sense: int = 0

    def heading(self, place: Point) -> Point:
        """Unit direction of the way at a place on it; raises ProgramError without a length."""
        if self.centre is None:
            return _unit(self.start, self.end)
        out = _unit(self.centre, place)
        return -out[1] * self.sense, out[0] * self.sense

    def holds(self, place: Point) -> bool:
        """Whether a place on the line or circle lies between start and end."""
        if self.centre is None:
            along = self.heading(place)
            size = (place[0] - self.start[0]) * along[0] + (place[1] - self.start[1]) * along[1]
            return -_STRAIGHT <= size <= math.dist(self.start, self.end) + _STRAIGHT
        turn = [
            self.sense * math.atan2(p[1] - self.centre[1], p[0] - self.centre[0])
            for p in (self.start, place, self.end)
        ]
        sweep = (turn[2] - turn[0]) % math.tau or math.tau
        return (turn[1] - turn[0] + _STRAIGHT) % math.tau <= sweep + 2.0 * _STRAIGHT

    def touched(self, centre: Point) -> Point:
        """Where a circle about `centre` touches it."""
        if self.centre is not None:
            radius = math.dist(self.start, self.centre)
            out = _unit(self.centre, centre)
            return self.centre[0] + radius * out[0], self.centre[1] + radius * out[1]
        along = self.heading(self.start)
        size = (centre[0] - self.start[0]) * along[0] + (centre[1] - self.start[1]) * along[1]
        return self.start[0] + size * along[0], self.start[1] + size * along[1]


@dataclass(frozen=True)
class Corner:
    """Where the first piece ends, where the second begins, and the sense of an arc between them."""

    begin: Point
    end: Point
    sense: int


def broken_corner(first: Piece, second: Piece, size: float, *, chamfer: bool) -> Corner | None:
    """Break the corner where one piece meets the next.

    Parameters
    ----------
    first, second : Piece
        The second begins where the first ends.
    size : float
        Radius, or length that a chamfer takes from each of two lines.
    chamfer : bool

    Returns
    -------
    Corner or None
        None where the way goes straight on.

    Raises
    ------
    ProgramError
        A piece has no length or is too short, or a chamfer is beside an arc.
    """
    arriving, leaving = first.heading(first.end), second.heading(first.end)
    cross = arriving[0] * leaving[1] - arriving[1] * leaving[0]
    if abs(cross) < _STRAIGHT:
        return None
    sense = 1 if cross > 0.0 else -1
    if first.centre is None and second.centre is None:
        back = -arriving[0], -arriving[1]
        half = math.atan2(abs(cross), back[0] * leaving[0] + back[1] * leaving[1]) / 2.0
        cut = size if chamfer else size / math.tan(half)
        shorter = min(math.dist(piece.start, piece.end) for piece in (first, second))
        if cut > shorter + _STRAIGHT:
            raise ProgramError(f"a corner of {size:g} does not fit between the two lines")
        at = first.end
        return Corner((at[0] + cut * back[0], at[1] + cut * back[1]),
                      (at[0] + cut * leaving[0], at[1] + cut * leaving[1]), sense)  # fmt: skip
    if chamfer:
        raise ProgramError("a chamfer beside an arc is not read", accepted="two lines")
    for centre in _centres(first, second, size, sense):
        begin, end = first.touched(centre), second.touched(centre)
        if first.holds(begin) and second.holds(end):
            return Corner(begin, end, sense)
    raise ProgramError(f"a rounding of {size:g} does not fit between the two pieces")


def _centres(first: Piece, second: Piece, size: float, sense: int) -> list[Point]:
    """Points at the distance `size` from both pieces on their inner side, the nearest first."""
    lines = [piece for piece in (first, second) if piece.centre is None]
    arcs = [piece for piece in (first, second) if piece.centre is not None]
    rings = [(arc.centre, math.dist(arc.start, arc.centre) - size * sense * arc.sense)
             for arc in arcs]  # fmt: skip
    if any(radius <= 0.0 for _, radius in rings):
        return []
    if lines:
        along = lines[0].heading(lines[0].start)
        start = (lines[0].start[0] - along[1] * size * sense,
                 lines[0].start[1] + along[0] * size * sense)  # fmt: skip
        found = _on_line(start, along, *rings[0])
    else:
        found = _on_both(*rings[0], *rings[1])
    return sorted(found, key=lambda place: math.dist(place, first.end))


def _on_line(start: Point, along: Point, centre: Point, radius: float) -> list[Point]:
    out = start[0] - centre[0], start[1] - centre[1]
    middle = -(out[0] * along[0] + out[1] * along[1])
    square = radius * radius - (out[0] * along[1] - out[1] * along[0]) ** 2
    if square < 0.0:
        return []
    return [(start[0] + along[0] * t, start[1] + along[1] * t)
            for t in (middle - math.sqrt(square), middle + math.sqrt(square))]  # fmt: skip


def _on_both(one: Point, radius: float, other: Point, other_radius: float) -> list[Point]:
    apart = math.dist(one, other)
    if apart == 0.0:
        return []
    along = _unit(one, other)
    middle = (apart * apart + radius * radius - other_radius * other_radius) / (2.0 * apart)
    square = radius * radius - middle * middle
    if square < 0.0:
        return []
    foot = one[0] + along[0] * middle, one[1] + along[1] * middle
    rise = math.sqrt(square)
    return [(foot[0] - along[1] * t, foot[1] + along[0] * t) for t in (rise, -rise)]


def _unit(start: Point, end: Point) -> Point:
    size = math.dist(start, end)
    if size == 0.0:
        raise ProgramError("a corner beside a line of no length")
    return (end[0] - start[0]) / size, (end[1] - start[1]) / size
