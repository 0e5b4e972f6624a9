"""Signed distance from a point to a tool, in the half plane of radius and height.

The distance to a convex set is the largest of u.x - h(u) over the unit normals u, with h the
support function; inside the set it is negative. For an outline of edges and (rounded) corners
that is the largest over the edges' lines and over the corners in whose cone of normals the
point lies. Turned about the axis it is the distance to the solid.

Source: R. Schneider, Convex Bodies: The Brunn-Minkowski Theory (2014), support functions.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stock.compiled import njit_inlined
from stock.tools import Corner, Tool

__all__ = ["Outlines", "build_outlines", "lower_bound", "outline_places", "signed_distance"]

#: a corner wins over an edge that ties with it within this, mm: it knows its curvature
_TIE_MM = 1e-12
#: fewest directions that a corner is looked at in
_IN_CONE = 3
#: places near the lower end of an edge, in spacings
_NEAR_END = (0.02, 0.1)


class Outlines(NamedTuple):
    """Outlines of all tools, those of tool t in the rows first[t] to first[t + 1] - 1.

    Attributes
    ----------
    edges : (E, 3) float64
        Unit normal (r, z) of an edge's line and the line's distance from the tip.
    corners : (C, 7) float64
        Centre (r, z), radius, and the normals (r, z) where its cone begins and ends,
        counter-clockwise.
    first_edge, first_corner : (T + 1,) int64
    height : (T,) float64
        Height of the tool's lowest rounding centre: where a sideways contact begins.
    """

    edges: np.ndarray
    corners: np.ndarray
    first_edge: np.ndarray
    first_corner: np.ndarray
    height: np.ndarray


def build_outlines(tools: Sequence[Tool]) -> Outlines:
    """Put the outlines of `tools` into arrays for the compiled kernels."""
    edges, corners = [], []
    first_edge, first_corner = [0], [0]
    for tool in tools:
        normals = _edge_normals(tool.corners)
        for angle, corner in normals:
            u = _unit(angle)
            edges.append((*u, u[0] * corner.r_mm + u[1] * corner.z_mm + corner.radius_mm))
        for (begin, _), (end, corner) in itertools.pairwise(normals):
            if end > begin:
                centre = (corner.r_mm, corner.z_mm, corner.radius_mm)
                corners.append((*centre, *_unit(begin), *_unit(end)))
        first_edge.append(len(edges))
        first_corner.append(len(corners))
    return Outlines(
        np.array(edges).reshape(-1, 3),
        np.array(corners).reshape(-1, 7),
        np.array(first_edge),
        np.array(first_corner),
        np.array([tool.corners[0].z_mm for tool in tools], dtype=float),
    )


def outline_places(tool: Tool, spacing_mm: float, phase: float = 0.5) -> np.ndarray:
    """Places of a tool's outline with their normals, (K, 4): r and z, normal by r and z.

    They are no farther apart than the spacing, nearer above the lower end of an edge, where
    shallow cuts end; a corner has some directions of its cone. `phase`, 0 to 1, moves them by
    parts of their distance.
    """
    normals = _edge_normals(tool.corners)
    places, last = [], (0.0, tool.corners[0].z_mm - tool.corners[0].radius_mm)
    for (begin, _), (end, corner) in itertools.pairwise(normals):
        first = _on_corner(corner, begin)
        places += [(*place, *_unit(begin)) for place in _along_edge(last, first, spacing_mm, phase)]
        count = max(_IN_CONE, math.ceil(corner.radius_mm * (end - begin) / spacing_mm))
        for k in range(count if end > begin else 0):
            angle = begin + (end - begin) * (k + phase) / count
            places.append((*_on_corner(corner, angle), *_unit(angle)))
        last = _on_corner(corner, end)
    top = _along_edge(last, (0.0, last[1]), spacing_mm, phase)
    return np.array([*places, *((*place, 0.0, 1.0) for place in top)])


def _on_corner(corner: Corner, angle: float) -> tuple[float, float]:
    """Point of a corner's rounding with this normal."""
    u = _unit(angle)
    return corner.r_mm + corner.radius_mm * u[0], corner.z_mm + corner.radius_mm * u[1]


def _along_edge(
    start: tuple, end: tuple, spacing_mm: float, phase: float
) -> list[tuple[float, float]]:
    """Places between two points of the outline."""
    length = math.dist(start, end)
    if length == 0.0:
        return []
    count = math.ceil(length / spacing_mm)
    ways = [share * spacing_mm for share in _NEAR_END] + [
        (k + phase) * length / count for k in range(count)
    ]
    shares = sorted({way / length for way in ways if way < length})
    return [tuple(a + s * (b - a) for a, b in zip(start, end, strict=True)) for s in shares]


def _edge_normals(corners: Sequence[Corner]) -> list[tuple[float, Corner]]:
    """Angle of each edge's normal from bottom (-pi/2) to top, with the corner that it ends.

    The horizontal normal is among them even where the outline has no upright edge, so that no
    corner's cone crosses it and each corner belongs to the lower or to the upper side.
    """
    angles = [-math.pi / 2]
    angles += [_common_normal(a, b) for a, b in itertools.pairwise(corners)]
    angles.append(math.pi / 2)
    normals = [(angles[0], corners[0])]
    for corner, begin, end in zip(corners, angles, angles[1:], strict=False):
        if begin < 0.0 < end:
            normals.append((0.0, corner))
        normals.append((end, corner))
    return normals


def _unit(angle: float) -> tuple[float, float]:
    """Unit vector at `angle`, exact along the axes."""
    r, z = math.cos(angle), math.sin(angle)
    return (0.0 if abs(r) < 1e-15 else r, 0.0 if abs(z) < 1e-15 else z)


def _common_normal(lower: Corner, upper: Corner) -> float:
    """Angle of the normal of the line that touches two corners from outside, rad."""
    dr, dz = upper.r_mm - lower.r_mm, upper.z_mm - lower.z_mm
    length = math.hypot(dr, dz)
    tilt = math.asin(max(-1.0, min(1.0, (upper.radius_mm - lower.radius_mm) / length)))
    angle = math.atan2(-dr, dz) - tilt
    return 0.0 if abs(angle) < 1e-15 else angle


@njit_inlined()
def signed_distance(outlines, tool, r, z):
    """Distance of the point (r, z) from the tool, its gradient, and the outline's curvature.

    Returns
    -------
    tuple of float
        Distance in mm (negative inside), gradient by r and by z, and 1 / distance from the
        corner's centre where the nearest point is on a corner, else 0.
    """
    best, gradient_r, gradient_z, curvature = -np.inf, 0.0, 0.0, 0.0
    for k in range(outlines.first_edge[tool], outlines.first_edge[tool + 1]):
        value = outlines.edges[k, 0] * r + outlines.edges[k, 1] * z - outlines.edges[k, 2]
        if value > best:
            best, gradient_r, gradient_z = value, outlines.edges[k, 0], outlines.edges[k, 1]
    for k in range(outlines.first_corner[tool], outlines.first_corner[tool + 1]):
        dr, dz = r - outlines.corners[k, 0], z - outlines.corners[k, 1]
        if _in_cone(outlines.corners, k, dr, dz):
            distance = math.sqrt(dr * dr + dz * dz)
            value = distance - outlines.corners[k, 2]
            if distance > 0.0 and value >= best - _TIE_MM:
                best, curvature = value, 1.0 / distance
                gradient_r, gradient_z = dr * curvature, dz * curvature
    return best, gradient_r, gradient_z, curvature


@njit_inlined()
def _in_cone(corners, k, dr, dz):
    return (
        corners[k, 3] * dz - corners[k, 4] * dr >= 0.0
        and dr * corners[k, 6] - dz * corners[k, 5] >= 0.0
    )


@njit_inlined()
def lower_bound(outlines, tool, r, z):
    """Bound below the distance of points at radius `r` that are no higher than `z`.

    The lower half of the outline repels a point the less the higher it is, so the highest one
    counts; the upper half, the blunt end of the tool, is left out.
    """
    best = -np.inf
    for k in range(outlines.first_edge[tool], outlines.first_edge[tool + 1]):
        if outlines.edges[k, 1] <= 0.0:
            best = max(
                best, outlines.edges[k, 0] * r + outlines.edges[k, 1] * z - outlines.edges[k, 2]
            )
    for k in range(outlines.first_corner[tool], outlines.first_corner[tool + 1]):
        dr, dz = r - outlines.corners[k, 0], z - outlines.corners[k, 1]
        if outlines.corners[k, 4] < 0.0 and _in_cone(outlines.corners, k, dr, dz):
            best = max(best, math.sqrt(dr * dr + dz * dz) - outlines.corners[k, 2])
    return best
