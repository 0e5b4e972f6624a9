"""Arcs that go on from the move before them without a corner: Klartext CT, SINUMERIK CT.

Source: closed form derived here; a circle is told by a point, its direction there, and an end.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from gcode.errors import ProgramError
from gcode.state.record import Record

__all__ = ["centre_behind", "tangent_centre"]

_STRAIGHT = 1e-12


def tangent_centre(
    record: Record, start: Sequence[float], end: Sequence[float], unit_mm: float
) -> tuple[float, float, float]:
    """Centre of the arc in G17, and its sense: positive counter-clockwise.

    Parameters
    ----------
    record : Record
        Its last row is the move before; in one frame with the row before that.
    start, end : sequence of float
        X and Y first, program units.
    unit_mm : float

    Raises
    ------
    ProgramError
        There is no direction, or the end lies straight ahead.
    """
    return centre_behind(_heading(record, unit_mm), start, end)


def centre_behind(
    heading: Sequence[float], start: Sequence[float], end: Sequence[float]
) -> tuple[float, float, float]:
    """Centre of the arc that leaves a point in a direction, and its sense as `tangent_centre`.

    Parameters
    ----------
    heading : (2,) sequence of float
        Unit direction at the start.
    start, end : sequence of float
        X and Y first.

    Raises
    ------
    ProgramError
        The end lies straight ahead.
    """
    out = end[0] - start[0], end[1] - start[1]
    across = heading[0] * out[1] - heading[1] * out[0]
    if abs(across) < _STRAIGHT:
        raise ProgramError("CT ends straight ahead")
    radius = (out[0] ** 2 + out[1] ** 2) / (2.0 * across)
    return start[0] - heading[1] * radius, start[1] + heading[0] * radius, across


def _heading(record: Record, unit_mm: float) -> tuple[float, float]:
    """Unit direction in the plane at the end of the last move."""
    if len(record) < 2:
        raise ProgramError("CT without a move before it")
    before, end = record.path().point_mm[-2:] / unit_mm
    arc = record.last_arc
    if arc is not None:
        out = end[0] - arc[4] / unit_mm, end[1] - arc[5] / unit_mm
        sense = 1.0 if arc[6] > 0 else -1.0
        along = -out[1] * sense, out[0] * sense
    else:
        along = end[0] - before[0], end[1] - before[1]
    size = math.hypot(*along)
    if size == 0.0:
        raise ProgramError("CT behind a move without a direction")
    return along[0] / size, along[1] / size
