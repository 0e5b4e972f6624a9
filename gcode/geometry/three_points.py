"""The circle through three points of a plane.

Source: closed form, the meeting point of the perpendicular bisectors.
"""

from __future__ import annotations

from collections.abc import Sequence

from gcode.errors import ProgramError

__all__ = ["centre_of_three"]

_STRAIGHT = 1e-12


def centre_of_three(
    first: Sequence[float], second: Sequence[float], third: Sequence[float]
) -> tuple[float, float]:
    """Centre; raises ProgramError where the points lie on a line."""
    ax, ay = second[0] - first[0], second[1] - first[1]
    bx, by = third[0] - first[0], third[1] - first[1]
    cross = 2.0 * (ax * by - ay * bx)
    if abs(cross) < _STRAIGHT:
        raise ProgramError("the three points of an arc lie on a line")
    a, b = ax * ax + ay * ay, bx * bx + by * by
    return first[0] + (by * a - ay * b) / cross, first[1] + (ax * b - bx * a) / cross
