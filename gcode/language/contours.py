"""A contour that a cycle is told: its lines and arcs, and on which side of it the tool runs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gcode.errors import ProgramError
from gcode.geometry.arcs import Point
from gcode.geometry.regions import CHORD_MM, Stretch, closed_area, polyline
from gcode.language.translate import number
from gcode.moves.clock import MachineLimits
from gcode.moves.moves import MoveKind
from gcode.moves.resolve import to_moves
from gcode.state.controller import Controller

__all__ = ["Contour", "contour_of"]


@dataclass(frozen=True)
class Contour:
    """A contour, program units.

    Attributes
    ----------
    start : Point
    way : tuple of Stretch
    side : int
        1 where the tool runs on its left, -1 on its right, 0 on it.
    """

    start: Point
    way: tuple[Stretch, ...]
    side: int

    @cached_property
    def is_island(self) -> bool:
        """Whether the tool runs outside; raises ProgramError without RL and RR."""
        if not self.side:
            raise ProgramError("a contour without RL or RR: pocket or island?")
        return (closed_area(polyline(self.start, self.way, CHORD_MM)) > 0.0) != (self.side > 0)

    @property
    def first_direction(self) -> Point:
        """Unit direction at its start."""
        first = self.way[0]
        if first.centre is None:
            out = first.end[0] - self.start[0], first.end[1] - self.start[1]
        else:
            sense = math.copysign(1.0, first.sweep_rad)
            out = ((first.centre[1] - self.start[1]) * sense,
                   (self.start[0] - first.centre[0]) * sense)  # fmt: skip
        size = math.hypot(*out)
        return out[0] / size, out[1] / size

    @property
    def last_direction(self) -> Point:
        """Unit direction at its end."""
        last = self.way[-1]
        before = self.way[-2].end if len(self.way) > 1 else self.start
        if last.centre is None:
            out = last.end[0] - before[0], last.end[1] - before[1]
        else:
            sense = math.copysign(1.0, last.sweep_rad)
            out = ((last.centre[1] - last.end[1]) * sense,
                   (last.end[0] - last.centre[0]) * sense)  # fmt: skip
        size = math.hypot(*out)
        return out[0] / size, out[1] / size

    def ends_beside(self, distance: float) -> tuple[Point, Point]:
        """Where a tool begins and ends that runs along it on its side at a distance."""
        places = (self.start, self.first_direction), (self.way[-1].end, self.last_direction)
        away = self.side * distance
        begin, end = ((x - v * away, y + u * away) for (x, y), (u, v) in places)
        return begin, end

    def blocks(self) -> Iterator[str]:
        """Its blocks of RS274/NGC behind the start."""
        here = self.start
        for stretch in self.way:
            text = f"x{number(stretch.end[0])}y{number(stretch.end[1])}"
            if stretch.centre is None:
                yield "g1" + text
            else:
                x, y = stretch.centre[0] - here[0], stretch.centre[1] - here[1]
                yield f"g{3 if stretch.sweep_rad > 0 else 2}{text}i{number(x)}j{number(y)}"
            here = stretch.end


def contour_of(controller: Controller, name: str, side: int = 0) -> Contour:
    """The contour that a controller of its own has gone along.

    Raises
    ------
    ProgramError
        It has gone nowhere.
    """
    moves = to_moves(controller.record, limits=MachineLimits(), home_mm=None)
    unit = controller.unit_mm
    rows = np.flatnonzero(moves.kind != MoveKind.DWELL)
    is_arc = moves.kind == MoveKind.ARC
    moved = np.hypot(*(moves.end_mm - moves.start_mm)[:, :2].T) > 0.0
    drawn = [k for k in rows[1:] if moved[k] or is_arc[k]]
    if not drawn:
        raise ProgramError(f"{name} holds no contour", accepted="lines and arcs in the plane")
    start = moves.end_mm[rows[0], :2] / unit
    way = []
    for k in drawn:
        end = tuple(float(v) for v in moves.end_mm[k, :2] / unit)
        if is_arc[k]:
            centre = tuple(float(v) for v in moves.centre_mm[k, :2] / unit)
            way.append(Stretch(end, centre, float(moves.sweep_rad[k] * moves.axis[k, 2])))
        else:
            way.append(Stretch(end))
    return Contour(tuple(map(float, start)), tuple(way), side)
