"""A corner between two lines of a plane, rounded or chamfered.

Source: HEIDENHAIN, TNC 640 User's Manual for Klartext Programming (RND, CHF); closed form derived
here: an arc of radius r in a corner of angle a touches both lines at r / tan(a / 2) from it.
"""

from __future__ import annotations

import math

from gcode.errors import ProgramError
from gcode.geometry.arcs import Point

__all__ = ["broken_corner"]

_STRAIGHT = 1e-9


def broken_corner(
    start: Point, corner: Point, end: Point, size: float, *, chamfer: bool
) -> tuple[Point, Point, int] | None:
    """Where the first line ends and the second begins.

    Parameters
    ----------
    start, corner, end : Point
        The two lines.
    size : float
        Radius, or length that a chamfer takes from each line.
    chamfer : bool

    Returns
    -------
    tuple or None
        The two points and the sense of the arc (1 counter-clockwise); None where the lines go
        straight on.

    Raises
    ------
    ProgramError
        A line has no length, or is too short.
    """
    back, ahead = _unit(corner, start), _unit(corner, end)
    cross = back[0] * ahead[1] - back[1] * ahead[0]
    if abs(cross) < _STRAIGHT:
        return None
    half = math.atan2(abs(cross), back[0] * ahead[0] + back[1] * ahead[1]) / 2.0
    cut = size if chamfer else size / math.tan(half)
    if cut > min(math.dist(corner, start), math.dist(corner, end)) + _STRAIGHT:
        raise ProgramError(f"a corner of {size:g} does not fit between the two lines")
    first = corner[0] + cut * back[0], corner[1] + cut * back[1]
    second = corner[0] + cut * ahead[0], corner[1] + cut * ahead[1]
    return first, second, 1 if cross < 0.0 else -1


def _unit(start: Point, end: Point) -> Point:
    size = math.dist(start, end)
    if size == 0.0:
        raise ProgramError("a corner beside a line of no length")
    return (end[0] - start[0]) / size, (end[1] - start[1]) / size
