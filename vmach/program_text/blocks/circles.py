"""Circles through points in a plane, in compiled code.

Source: closed form derived here: the circle through three points, and angles about its centre.
"""

from __future__ import annotations

import math

import numpy as np

from stock.compiled import njit_inlined, njit_kernel

__all__ = ["circle_centre", "length", "swept"]

#: a circle of larger radius is written as a line
_LARGEST_RADIUS_MM = 1e5


@njit_inlined()
def length(x, y):
    """Length of a vector."""
    return math.sqrt(x * x + y * y)


@njit_kernel()
def circle_centre(first, middle, last):
    """Whether three points (2,) lie on a circle and not in line, and its centre."""
    ax, ay, bx, by = (
        middle[0] - first[0],
        middle[1] - first[1],
        last[0] - first[0],
        last[1] - first[1],
    )
    aa, bb = ax * ax + ay * ay, bx * bx + by * by
    twice_area = 2.0 * (ax * by - ay * bx)
    if abs(twice_area) * _LARGEST_RADIUS_MM <= abs(aa * math.sqrt(bb)):
        return False, 0.0, 0.0
    x, y = (by * aa - ay * bb) / twice_area, (ax * bb - bx * aa) / twice_area
    return True, first[0] + x, first[1] + y


@njit_inlined()
def swept(x, y, first, last, is_counter_clockwise):
    """Angle about a centre from one point (2,) to another in a sense, 0 to 2 pi, rad."""
    fx, fy, lx, ly = first[0] - x, first[1] - y, last[0] - x, last[1] - y
    angle = math.atan2(fx * ly - fy * lx, fx * lx + fy * ly)
    return np.mod(angle if is_counter_clockwise else -angle, 2.0 * math.pi)
