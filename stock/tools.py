"""Cutting tools: convex solids of revolution, told by the corners of their outline."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from numbers import Real

from stock.errors import StockError

__all__ = ["TOOL_SHAPES", "Corner", "Tool", "make_tool"]

#: a turn of the outline by less than this counts as straight, rad
_STRAIGHT_RAD = 1e-12


@dataclass(frozen=True)
class Corner:
    """A corner of the outline in the half plane of radius and height: a circle, or a point."""

    r_mm: float  #: distance of the corner's centre from the tool axis
    z_mm: float  #: height of the corner's centre above the tip
    radius_mm: float = 0.0  #: radius of the rounding, 0 for a sharp corner


@dataclass(frozen=True)
class Tool:
    """The cutting part of a tool: its outline turned about +Z, tip at the origin.

    The outline runs from the axis at the bottom to the axis at the top along straight edges
    that join its corners; it is convex. Shank and holder do not cut and are not part of it.

    Attributes
    ----------
    shape : str
        A key of `TOOL_SHAPES`.
    diameter_mm, length_mm : float
        Largest diameter, and height of the cutting part.
    corners : tuple of Corner
        From bottom to top; the top one is sharp.
    """

    shape: str
    diameter_mm: float
    length_mm: float
    corners: tuple[Corner, ...]


def make_tool(shape: str, **dimensions: float | Sequence[tuple[float, float]]) -> Tool:
    """Make a tool from its shape and dimensions.

    Parameters
    ----------
    shape : str
        ``flat``, ``ball``, ``bull``, ``chamfer``, ``drill`` or ``profile``.
    **dimensions
        ``diameter_mm`` and ``length_mm`` for all but ``profile``; ``corner_radius_mm`` for
        ``bull``; ``angle_deg`` (included, default 90) and ``tip_diameter_mm`` (default 0) for
        ``chamfer``; ``angle_deg`` (included point angle, default 118) for ``drill``;
        ``points_mm``, pairs (r, z) from the bottom to the top of a convex outline, for
        ``profile``. ``flute_length_mm``, where given, is the cutting height in place of
        ``length_mm``.

    Returns
    -------
    Tool

    Raises
    ------
    StockError
        If the shape or a dimension is unknown, missing or impossible.
    """
    if shape not in TOOL_SHAPES:
        raise StockError(f"tool shape {shape!r} is unknown", accepted=", ".join(TOOL_SHAPES))
    required, optional, build = TOOL_SHAPES[shape]
    missing = [name for name in required if name not in dimensions]
    unknown = [name for name in dimensions if name not in (*required, *optional)]
    if missing or unknown:
        what = f"lacks {missing[0]}" if missing else f"has the unknown dimension {unknown[0]}"
        raise StockError(f"{shape} tool {what}", accepted=", ".join((*required, *optional)))
    return build(**dimensions)


def _cutting_height(length_mm: float, flute_length_mm: float | None) -> float:
    length_mm = _number("length_mm", length_mm, above=0.0)
    if flute_length_mm is None:
        return length_mm
    return _number("flute_length_mm", flute_length_mm, above=0.0, most=length_mm)


def _flat(diameter_mm: float, length_mm: float, flute_length_mm: float | None = None) -> Tool:
    radius = _number("diameter_mm", diameter_mm, above=0.0) / 2
    height = _cutting_height(length_mm, flute_length_mm)
    return _tool("flat", [Corner(radius, 0.0), Corner(radius, height)])


def _ball(diameter_mm: float, length_mm: float, flute_length_mm: float | None = None) -> Tool:
    radius = _number("diameter_mm", diameter_mm, above=0.0) / 2
    height = _cutting_height(length_mm, flute_length_mm)
    _number("cutting height of the ball tool", height, least=radius)
    return _tool("ball", [Corner(0.0, radius, radius), Corner(radius, height)])


def _bull(
    diameter_mm: float,
    length_mm: float,
    corner_radius_mm: float,
    flute_length_mm: float | None = None,
) -> Tool:
    radius = _number("diameter_mm", diameter_mm, above=0.0) / 2
    corner = _number("corner_radius_mm", corner_radius_mm, least=0.0, most=radius)
    height = _cutting_height(length_mm, flute_length_mm)
    _number("cutting height of the bull-nose tool", height, least=corner)
    return _tool("bull", [Corner(radius - corner, corner, corner), Corner(radius, height)])


def _chamfer(
    diameter_mm: float,
    length_mm: float,
    angle_deg: float = 90.0,
    tip_diameter_mm: float = 0.0,
    flute_length_mm: float | None = None,
) -> Tool:
    return _cone("chamfer", diameter_mm, tip_diameter_mm, angle_deg, length_mm, flute_length_mm)


def _drill(
    diameter_mm: float,
    length_mm: float,
    angle_deg: float = 118.0,
    flute_length_mm: float | None = None,
) -> Tool:
    return _cone("drill", diameter_mm, 0.0, angle_deg, length_mm, flute_length_mm)


def _cone(shape, diameter_mm, tip_diameter_mm, angle_deg, length_mm, flute_length_mm) -> Tool:
    radius = _number("diameter_mm", diameter_mm, above=0.0) / 2
    tip = _number("tip_diameter_mm", tip_diameter_mm, least=0.0, below=diameter_mm) / 2
    half = math.radians(_number("angle_deg", angle_deg, above=0.0, below=180.0) / 2)
    height = _cutting_height(length_mm, flute_length_mm)
    shoulder = (radius - tip) / math.tan(half)
    if height <= shoulder:  # the cutting part ends on the cone
        return _tool(shape, [Corner(tip, 0.0), Corner(tip + height * math.tan(half), height)])
    return _tool(shape, [Corner(tip, 0.0), Corner(radius, shoulder), Corner(radius, height)])


def _profile(points_mm: Sequence[tuple[float, float]]) -> Tool:
    points = []
    for pair in points_mm:
        if len(pair) != 2:
            raise StockError(f"profile point {pair!r} is no pair", accepted="(r, z) in mm")
        r, z = (float(_number("profile point", value)) for value in pair)
        points.append((_number("radius of a profile point", r, least=0.0), z))
    if len(points) > 1 and points[-1][0] == 0.0:
        points.pop()  # the top is closed by itself
    if len(points) < 2 or max(r for r, _ in points) == 0.0:
        raise StockError(
            f"profile has {len(points)} points off its top end and encloses no volume",
            accepted="at least two points (r, z), from the bottom to the top",
        )
    bottom = points[0][1]
    _check_convex(points)
    return _tool("profile", [Corner(r, z - bottom) for r, z in points])


def _check_convex(points: list[tuple[float, float]]) -> None:
    closed = [(0.0, points[0][1]), *points, (0.0, points[-1][1])]
    closed = [a for a, b in itertools.pairwise(closed) if a != b] + closed[-1:]
    for (r0, z0), (r1, z1), (r2, z2) in zip(closed, closed[1:], closed[2:], strict=False):
        cross = (r1 - r0) * (z2 - z1) - (z1 - z0) * (r2 - r1)
        if cross < -_STRAIGHT_RAD * math.hypot(r1 - r0, z1 - z0) * math.hypot(r2 - r1, z2 - z1):
            raise StockError(
                f"profile is not convex at r = {r1:g} mm, z = {z1:g} mm",
                accepted="a convex outline from the bottom to the top",
                hint="give the cutting part alone, without neck and shank",
            )


def _tool(shape: str, corners: list[Corner]) -> Tool:
    widest = max(corner.r_mm + corner.radius_mm for corner in corners)
    return Tool(shape, 2 * widest, corners[-1].z_mm, tuple(corners))


def _number(
    name: str,
    value: float,
    *,
    above: float = -math.inf,
    least: float = -math.inf,
    below: float = math.inf,
    most: float = math.inf,
) -> float:
    """`value` as a float, or an error that says which range it has to be in."""
    good = isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)
    if good and above < value < below and least <= value <= most:
        return float(value)
    limits = [(">", above), (">=", least), ("<", below), ("<=", most)]
    accepted = [f"{sign} {limit:g}" for sign, limit in limits if math.isfinite(limit)]
    raise StockError(f"{name} = {value!r}", accepted=" and ".join(["a finite number", *accepted]))


_SIZE = ("diameter_mm", "length_mm")

#: shape -> (dimensions it needs, dimensions it may have, what makes it)
TOOL_SHAPES: dict[str, tuple[tuple[str, ...], tuple[str, ...], Callable[..., Tool]]] = {
    "flat": (_SIZE, ("flute_length_mm",), _flat),
    "ball": (_SIZE, ("flute_length_mm",), _ball),
    "bull": ((*_SIZE, "corner_radius_mm"), ("flute_length_mm",), _bull),
    "chamfer": (_SIZE, ("angle_deg", "tip_diameter_mm", "flute_length_mm"), _chamfer),
    "drill": (_SIZE, ("angle_deg", "flute_length_mm"), _drill),
    "profile": (("points_mm",), (), _profile),
}
