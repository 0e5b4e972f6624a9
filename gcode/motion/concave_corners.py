"""Where two compensated moves meet in a concave corner: the end at which the first one stops.

A corner that the tool cannot reach is refused.

Source: LinuxCNC, Cutter Compensation; closed form derived here: the crossing of two offset lines
or circles.
"""

from __future__ import annotations

import math

from gcode.errors import ProgramError
from gcode.geometry.arcs import Point
from gcode.motion.compensated_path import (
    HALF,
    QUARTER,
    CompensatedPath,
    beside,
    direction,
    distance,
)
from gcode.state.compensation_queue import WaitingMove

__all__ = ["arc_after_arc", "arc_after_line", "line_after_arc", "line_after_line"]


def line_after_line(path: CompensatedPath, beta: float, theta: float) -> Point:
    """Concave corner of two lines: both are cut back by the same length."""
    half_corner = (beta + HALF) / 2.0
    if half_corner == 0.0:
        raise ProgramError("inside corner of zero degrees with cutter compensation on")
    retreat = path.radius / math.tan(half_corner)
    return beside(path.current, retreat, theta + path.side * QUARTER)


def line_after_arc(path: CompensatedPath, arc_before: WaitingMove, heading: float) -> Point:
    """Concave corner of an arc and a line: where the offset line cuts the offset arc."""
    centre, ccw = arc_before.centre, arc_before.turns > 0
    radius = distance(centre, arc_before.end)
    inside = path.inside(arc_before.turns)
    contour_radius = radius + path.radius if inside else radius - path.radius
    theta = heading + (QUARTER if ccw else -QUARTER)
    depth = contour_radius * math.cos(theta - direction(path.programmed, centre))
    depth += -path.radius if inside else path.radius
    ratio = depth / radius if radius else math.inf
    if abs(ratio) > 1.0:
        raise ProgramError(
            f"arc of radius {radius:.6g} to straight motion makes a corner the compensated tool of "
            f"radius {path.radius:.6g} can't fit in without gouging",
            hint="use a smaller tool",
        )
    swing = math.acos(ratio) if ccw != inside else -math.acos(ratio)
    return beside(centre, radius, theta + HALF + swing)


def arc_after_line(
    path: CompensatedPath, centre: Point, turns: int, *, radius: float, beta: float, theta: float
) -> Point:
    """Concave corner of a line and an arc: where the offset arc cuts the offset line."""
    inside = path.inside(turns)
    across = radius * math.sin(beta - QUARTER) + (path.radius if inside else -path.radius)
    reach = radius - path.radius if inside else radius + path.radius
    ratio = across / reach if reach else math.inf
    if abs(ratio) > 1.0:
        raise ProgramError(
            f"arc move of radius {radius:.6g} in a concave corner cannot be reached by the tool of "
            f"radius {path.radius:.6g} without gouging",
            hint="use a smaller tool",
        )
    swing = math.asin(ratio) if turns > 0 else -math.asin(ratio)
    angle = theta + swing if inside else theta + HALF - swing
    return beside(centre, reach, angle)


def arc_after_arc(
    path: CompensatedPath, before: WaitingMove, centre: Point, *, turns: int, radius: float
) -> Point:
    """Concave corner of two arcs: where the offset arcs meet (law of cosines)."""
    old_radius = distance(before.centre, before.end)
    new_radius = radius - path.radius if path.inside(turns) else radius + path.radius
    between = distance(before.centre, centre)
    if old_radius == 0.0 or between == 0.0:
        raise ProgramError(
            "arc to arc motion is invalid because the arcs have the same centre or no radius: "
            f"centres {between:.6g} apart, radius {old_radius:.6g}"
        )
    cosine = (old_radius**2 + between**2 - new_radius**2) / (2.0 * old_radius * between)
    if abs(cosine) > 1.0:
        raise ProgramError(
            f"arc of radius {old_radius:.6g} to arc of radius {radius:.6g} makes a corner the "
            f"compensated tool of radius {path.radius:.6g} can't fit in without gouging",
            hint="use a smaller tool",
        )
    pullback = math.acos(cosine) if path.inside(before.turns) == (turns > 0) else -math.acos(cosine)
    return beside(before.centre, old_radius, direction(before.centre, centre) + pullback)
