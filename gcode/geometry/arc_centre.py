"""Centre of an arc and its radii in plain numbers: the interpreter and compiled code share them.

Both must give the same bits, so nothing here depends on how a language computes a square root of
a sum: `distance` is rounded correctly but for one case in about 1e9. The fast lane compiles these
functions (njit).

Source: T. J. Dekker, Numer. Math. 18 (1971) 224-242 (exact products); closed form derived here:
centre = middle of the chord + sqrt(R^2 - (chord / 2)^2) across it.
"""

from __future__ import annotations

import math

__all__ = ["centre_of_radius", "distance", "radii_differ"]

#: splits a double into two halves of 26 bits
_SPLIT = 134217729.0
#: beyond these squares overflow, or lose digits
_LARGE, _SMALL = 1e140, 1e-140
#: share of the radius below which the ends of an arc count as opposite each other
_SEMICIRCLE = 1e-12


def distance(x: float, y: float) -> float:
    """sqrt(x^2 + y^2)."""
    a, b = abs(x), abs(y)
    if a < b:
        a, b = b, a
    if b == 0.0:
        return a
    if not (a < _LARGE and b > _SMALL):
        return a * math.sqrt(1.0 + (b / a) * (b / a))
    h = math.sqrt(a * a + b * b)
    t = _SPLIT * h
    h1 = t - (t - h)
    h2 = h - h1
    t = _SPLIT * a
    a1 = t - (t - a)
    a2 = a - a1
    t = _SPLIT * b
    b1 = t - (t - b)
    b2 = b - b1
    hh, aa, bb = h * h, a * a, b * b
    h_low = ((h1 * h1 - hh) + 2.0 * h1 * h2) + h2 * h2
    a_low = ((a1 * a1 - aa) + 2.0 * a1 * a2) + a2 * a2
    b_low = ((b1 * b1 - bb) + 2.0 * b1 * b2) + b2 * b2
    left = ((aa - hh) + bb) + ((a_low - h_low) + b_low)  # a^2 + b^2 - h^2
    return h + left / (2.0 * h)


def radii_differ(
    radius: float, end_radius: float, allowed: float, ceiling: float, relative: float
) -> bool:
    """Whether the radii at start and end of an arc differ by more than a control accepts.

    Parameters
    ----------
    radius, end_radius : float
        Program units; not both zero.
    allowed, ceiling, relative : float
        As `gcode.geometry.arc_tolerance.ArcTolerance` has them, `allowed` in program units.
    """
    difference = abs(radius - end_radius)
    share = difference / max(radius, end_radius)
    return difference > allowed * ceiling or (share > relative and difference > allowed)


def centre_of_radius(
    x0: float, y0: float, x1: float, y1: float, half: float, radius: float, clockwise: bool
) -> tuple[float, float]:
    """Centre of an arc given by R, from start to end; `half` of the chord is no more than R."""
    size = abs(radius)
    if half / size > 1.0 - _SEMICIRCLE:
        half = size
    quarter = -math.pi / 2.0 if clockwise == (radius > 0.0) else math.pi / 2.0
    direction = math.atan2(y1 - y0, x1 - x0) + quarter
    away = size * math.cos(math.asin(half / size))
    middle_x, middle_y = (x1 + x0) / 2.0, (y1 + y0) / 2.0
    return middle_x + away * math.cos(direction), middle_y + away * math.sin(direction)
