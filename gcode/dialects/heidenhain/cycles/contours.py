"""A contour in a subprogram: its lines and arcs, and on which side of it the tool runs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gcode.errors import ProgramError
from gcode.geometry.arcs import Point
from gcode.geometry.regions import CHORD_MM, Stretch, closed_area, polyline
from gcode.language.translate import number
from gcode.moves.clock import MachineLimits
from gcode.moves.moves import MoveKind
from gcode.moves.resolve import to_moves
from gcode.state.controller import Controller

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["Contour", "read_contour"]


@dataclass(frozen=True)
class Contour:
    """A contour, program units.

    Attributes
    ----------
    start : Point
    way : tuple of Stretch
    side : int
        1 for RL, -1 for RR, 0 without.
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


def read_contour(reader: KlartextReader, label: str) -> Contour:
    """Read the lines from LBL to LBL 0 apart from the program, without moving anything.

    Raises
    ------
    ProgramError
        There is no such label, or nothing of a contour in it.
    """
    outer = reader.controller
    controller = Controller(outer.tools, outer.tolerance, outer.machine_unit_mm)
    inner = reader.apart(controller)
    inner.parameters, inner.budget, inner.contents = (
        reader.parameters, reader.budget, reader.contents,
    )  # fmt: skip
    inner.motion.sides = sides = []
    inner.motion.feed = inner.motion.tool_feed = 1.0
    inner.execute("g20" if outer.unit_mm != 1.0 else "g21", "g17g90g40g80")
    target = reader.flow.find(label)
    inner.flow.calls.append((target, inner.stop, -1, 0))
    inner.next = target + 1
    try:
        inner.run()
    except ProgramError as error:
        raise ProgramError(f"contour LBL {label}: {error.what}", accepted=error.accepted,
                           hint=error.hint) from None  # fmt: skip
    return _contour(controller, sides, label)


def _contour(controller: Controller, sides: list[int], label: str) -> Contour:
    moves = to_moves(controller.record, limits=MachineLimits(), home_mm=None)
    unit = controller.unit_mm
    rows = np.flatnonzero(moves.kind != MoveKind.DWELL)
    is_arc = moves.kind == MoveKind.ARC
    moved = np.hypot(*(moves.end_mm - moves.start_mm)[:, :2].T) > 0.0
    drawn = [k for k in rows[1:] if moved[k] or is_arc[k]]
    if not drawn:
        raise ProgramError(f"LBL {label} holds no contour", accepted="L, C and CR with RL or RR")
    start = moves.end_mm[rows[0], :2] / unit
    way = []
    for k in drawn:
        end = tuple(float(v) for v in moves.end_mm[k, :2] / unit)
        if is_arc[k]:
            centre = tuple(float(v) for v in moves.centre_mm[k, :2] / unit)
            way.append(Stretch(end, centre, float(moves.sweep_rad[k] * moves.axis[k, 2])))
        else:
            way.append(Stretch(end))
    if any(side != sides[0] for side in sides):
        raise ProgramError(f"LBL {label} has RL and RR", accepted="one of them")
    return Contour(tuple(map(float, start)), tuple(way), sides[0] if sides else 0)
