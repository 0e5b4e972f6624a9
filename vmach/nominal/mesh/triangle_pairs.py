"""Compiled test of pairs of triangles: whether one cuts through the other, or lies on it.

Source: closed form derived here: where an edge meets a plane, in barycentric coordinates;
separating axes within one plane.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

__all__ = ["count_hits"]

#: heights over a plane, and distances from the sides of a triangle, that count as none
_RELATIVE = 1e-6


@njit(cache=True, nogil=True)
def count_hits(corners, triangles, pairs, rounding_mm):
    """How many of the pairs (K, 2) of triangles (T, 3) with corners (T, 3, 3) mm meet.

    An edge of one passes through the inside of the other, unless they share a side; or they
    overlap within one plane by more than the rounding of the coordinates.
    """
    hits = 0
    for k in range(len(pairs)):
        one, other = corners[pairs[k, 0]], corners[pairs[k, 1]]
        shared = 0
        for i in range(3):
            for j in range(3):
                shared += triangles[pairs[k, 0], i] == triangles[pairs[k, 1], j]
        if (shared < 2 and (_pierces(one, other) or _pierces(other, one))) or _overlap_in_plane(
            one, other, rounding_mm
        ):
            hits += 1
    return hits


@njit(cache=True, nogil=True)
def _minus(a, b):
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@njit(cache=True, nogil=True)
def _cross(a, b):
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit(cache=True, nogil=True)
def _dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True, nogil=True)
def _pierces(edges_of, through):
    """Whether an edge of one triangle passes through the inside of the other."""
    u, v = _minus(through[1], through[0]), _minus(through[2], through[0])
    normal = _cross(u, v)
    area = math.sqrt(_dot(normal, normal))
    height, size = np.empty(3), 0.0
    for i in range(3):
        away = _minus(edges_of[i], through[0])
        height[i] = _dot(away, normal)
        size = max(size, abs(away[0]), abs(away[1]), abs(away[2]))
    least = _RELATIVE * size * area
    for i in range(3):
        j = (i + 1) % 3
        if min(abs(height[i]), abs(height[j])) <= least or height[i] * height[j] >= 0.0:
            continue
        share = height[i] / (height[i] - height[j])
        start, step = _minus(edges_of[i], through[0]), _minus(edges_of[j], edges_of[i])
        at = (
            start[0] + share * step[0],
            start[1] + share * step[1],
            start[2] + share * step[2],
        )
        s = _dot(_cross(at, v), normal) / area**2
        t = _dot(_cross(u, at), normal) / area**2
        if s > _RELATIVE and t > _RELATIVE and s + t < 1.0 - _RELATIVE:
            return True
    return False


@njit(cache=True, nogil=True)
def _overlap_in_plane(one, other, rounding_mm):
    """Whether two triangles of one plane share area: no side has all of the other beyond it."""
    normal = _cross(_minus(one[1], one[0]), _minus(one[2], one[0]))
    across = _cross(_minus(other[1], other[0]), _minus(other[2], other[0]))
    length, width = math.sqrt(_dot(normal, normal)), math.sqrt(_dot(across, across))
    size = 0.0
    for i in range(3):
        for triangle in (one, other):
            away = _minus(triangle[i], one[0])
            size = max(size, abs(away[0]), abs(away[1]), abs(away[2]))
    # a triangle that is not higher than the rounding has no plane
    if not min(length, width) > rounding_mm * size:
        return False
    unit = (normal[0] / length, normal[1] / length, normal[2] / length)
    for i in range(3):
        if abs(_dot(_minus(other[i], one[0]), unit)) > rounding_mm:
            return False
    return not (
        _beyond_a_side(one, other, unit, rounding_mm)
        or _beyond_a_side(other, one, unit, rounding_mm)
    )


@njit(cache=True, nogil=True)
def _beyond_a_side(first, second, normal, rounding_mm):
    """Whether across some side of the first triangle the two lie apart, within their plane."""
    for i in range(3):
        axis = _cross(normal, _minus(first[(i + 1) % 3], first[i]))
        length = max(math.sqrt(_dot(axis, axis)), 1e-300)
        least_x = least_y = math.inf
        most_x = most_y = -math.inf
        for k in range(3):
            x = _dot(_minus(first[k], first[0]), axis) / length
            y = _dot(_minus(second[k], first[0]), axis) / length
            least_x, most_x = min(least_x, x), max(most_x, x)
            least_y, most_y = min(least_y, y), max(most_y, y)
        if max(least_y - most_x, least_x - most_y) >= -rounding_mm:
            return True
    return False
