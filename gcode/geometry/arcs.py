"""Geometry of G2 and G3: centre from I J K or R, checks, swept angle.

Source: NISTIR 6556 (RS274/NGC), G2 and G3; closed form derived here: centre = middle of the chord
+ sqrt(R^2 - (chord / 2)^2) across it.
"""

from __future__ import annotations

import math

from gcode.errors import ProgramError
from gcode.geometry.arc_centre import centre_of_radius, distance, radii_differ
from gcode.geometry.arc_tolerance import ZERO_RADIUS_MM, ArcTolerance

__all__ = ["ZERO_RADIUS_MM", "arc_angle", "arc_length", "centre_from_offsets", "centre_from_radius"]

Point = tuple[float, float]


def centre_from_offsets(
    start: Point, end: Point, offsets: Point, *, absolute: bool, tolerance: ArcTolerance,
    unit_mm: float,
) -> Point:  # fmt: skip
    """Centre of an arc given by I J K, checked against the tolerance of the control.

    Parameters
    ----------
    start, end : tuple of float
        First and second coordinate, program units.
    offsets : tuple of float
        Centre, or centre minus start.
    absolute : bool
        G90.1: `offsets` is the centre itself.
    tolerance : ArcTolerance
        Accepted difference of radii.
    unit_mm : float
        Program unit.

    Raises
    ------
    ProgramError
        Radius zero, or radii at start and end that differ too much.
    """
    centre = offsets if absolute else (start[0] + offsets[0], start[1] + offsets[1])
    radius = distance(centre[0] - start[0], centre[1] - start[1])
    end_radius = distance(centre[0] - end[0], centre[1] - end[1])
    if min(radius, end_radius) < ZERO_RADIUS_MM / unit_mm:
        raise ProgramError(
            f"arc with radius zero: {radius:.6g} at its start, {end_radius:.6g} at its end",
            hint="check I, J, K and the start of the arc",
        )
    allowed = tolerance.absolute(unit_mm)
    if radii_differ(radius, end_radius, allowed, tolerance.ceiling, tolerance.relative):
        difference = abs(radius - end_radius)
        raise ProgramError(
            f"radius to end of arc differs from radius to start: {radius:.6g} and "
            f"{end_radius:.6g}, difference {difference:.4g} "
            f"({difference / max(radius, end_radius):.3%})",
            accepted=f"up to {allowed:.4g} or {tolerance.relative:.2%}",
            hint="check the end point and I, J, K",
        )
    return centre


def centre_from_radius(
    start: Point, end: Point, radius: float, *, clockwise: bool, unit_mm: float
) -> Point:
    """Centre of an arc given by R; a negative radius asks for more than a semicircle.

    Raises
    ------
    ProgramError
        Start and end coincide, or are further apart than the diameter.
    """
    if start == end:
        raise ProgramError(
            f"arc with R{radius:g} ends where it starts", hint="use I J K for a full circle"
        )
    size = abs(radius)
    half = distance((end[0] + start[0]) / 2.0 - end[0], (end[1] + start[1]) / 2.0 - end[1])
    if half - size > ZERO_RADIUS_MM / unit_mm:
        raise ProgramError(
            f"arc radius {size:g} is too small to reach the end point",
            accepted=f"at least {half:.6g}",
        )
    if size == 0.0:
        raise ProgramError("arc radius R is zero")
    return centre_of_radius(*start, *end, half, radius, clockwise)


def arc_angle(start: Point, end: Point, centre: Point, turns: int) -> float:
    """Signed angle swept from start to end, positive counter-clockwise.

    Parameters
    ----------
    turns : int
        Full or partial circles, negative clockwise; 0 sweeps nothing.
    """
    if turns == 0:
        return 0.0
    alpha = math.atan2(start[1] - centre[1], start[0] - centre[0])
    beta = math.atan2(end[1] - centre[1], end[0] - centre[0])
    if turns > 0:
        if beta <= alpha:
            beta += 2.0 * math.pi
        return beta - alpha + (turns - 1) * 2.0 * math.pi
    if alpha <= beta:
        alpha += 2.0 * math.pi
    return beta - alpha + (turns + 1) * 2.0 * math.pi


def arc_length(start: Point, end: Point, centre: Point, *, turns: int, rise: float) -> float:
    """Length of a helical arc with the radius at its start."""
    radius = math.hypot(centre[0] - start[0], centre[1] - start[1])
    return math.hypot(radius * arc_angle(start, end, centre, turns), rise)
