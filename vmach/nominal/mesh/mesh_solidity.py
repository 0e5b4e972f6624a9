"""Does a closed mesh enclose each place of a solid exactly once?

A closed, consistently wound mesh can still hold no solid: every triangle twice, a surface and
its reverse, a flattened part, one body inside another with the same sense. The winding number
tells them apart: it is 1 inside a solid and 0 outside (Jacobson, Kavan and Sorkine-Hornung 2013).

Source: Jacobson, Kavan and Sorkine-Hornung, Robust inside-outside segmentation using generalized
winding numbers, ACM Trans. Graph. 32 (2013) 33.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from vmach.errors import InputError
from vmach.nominal.mesh.unique_rows import unique_rows

__all__ = ["check_each_triangle_once", "check_encloses_once", "winding_numbers"]

_ACCEPTED = "the surface of a solid, each place of it once"
_HINT = "unite the bodies in the CAD system and export again"

#: volume over (area x size) below which a mesh is flat: the rounding of 32-bit coordinates
_FLAT = 1e-7

#: a winding number is asked for this far from a triangle, as a share of the root of its area
_BESIDE = 1e-3

#: bodies of one file whose winding numbers are looked at, the largest triangles first
_MOST_BODIES = 500


def check_each_triangle_once(path: Path, triangles: np.ndarray) -> None:
    """Raise InputError where three vertices carry more than one of the (T, 3) triangles."""
    _, _, count = unique_rows(np.sort(triangles, axis=1))
    repeated = int((count > 1).sum())
    if repeated:
        raise InputError(
            f"{repeated} of {len(count)} triangles occur more than once, as they are or reversed",
            file=path,
            accepted=_ACCEPTED,
            hint=_HINT,
        )


def check_encloses_once(
    path: Path, vertices: np.ndarray, triangles: np.ndarray, *, bodies_touch: bool = False
) -> None:
    """Raise InputError unless (T, 3) triangles wind once behind, never before, each body's surface.

    The mesh is closed and its whole volume positive. Bodies that may touch have 0 or 1 before.
    """
    corners = vertices[triangles]
    doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(doubled, axis=1) / 2.0
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    inner = corners - (low + high) / 2.0
    volume = np.einsum("ij,ij->", inner[:, 0], np.cross(inner[:, 1], inner[:, 2])) / 6.0
    if abs(volume) <= _FLAT * area.sum() * (high - low).max():
        raise InputError(
            f"the mesh encloses no volume: {volume:.3g} mm3 within a surface of "
            f"{area.sum():.3g} mm2",
            file=path,
            accepted=_ACCEPTED,
            hint="a flattened part, or a surface and its reverse",
        )
    chosen = _largest_of_bodies(triangles, area)
    middle = corners[chosen].mean(axis=1)
    normal = doubled[chosen] / (2.0 * area[chosen])[:, None]
    step = _BESIDE * np.sqrt(area[chosen])[:, None] * normal
    behind, before = (winding_numbers(middle + s, corners) for s in (-step, step))
    wrong = np.flatnonzero((np.round(behind) != 1) | (np.round(before) != 0) & (not bodies_touch))
    if wrong.size:
        x, y, z = middle[wrong[0]]
        raise InputError(
            f"the surface near ({x:.3f}, {y:.3f}, {z:.3f}) has material "
            f"{round(behind[wrong[0]])} times behind it and {round(before[wrong[0]])} times "
            "before it",
            file=path,
            accepted="1 behind and 0 before: outer surfaces outwards, voids inwards, nothing twice",
            hint=_HINT,
        )


def _largest_of_bodies(triangles: np.ndarray, area: np.ndarray) -> np.ndarray:
    """The largest triangle of each connected body, largest first."""
    count = int(triangles.max()) + 1
    sides = triangles[:, [0, 1]], triangles[:, [1, 2]]
    start, end = np.vstack(sides).T
    graph = coo_array((np.ones(len(start)), (start, end)), shape=(count, count))
    body = connected_components(graph, directed=False)[1][triangles[:, 0]]
    order = np.argsort(-area, kind="stable")
    _, first = np.unique(body[order], return_index=True)
    return order[np.sort(first)[:_MOST_BODIES]]


def winding_numbers(points_mm: np.ndarray, corners_mm: np.ndarray) -> np.ndarray:
    """How often a closed mesh (T, 3, 3) winds around each of the points (P, 3), (P,).

    The solid angles of the triangles over 4 pi (van Oosterom and Strackee 1983, equation 8).
    """
    found = np.empty(len(points_mm))
    for row, point in enumerate(points_mm):
        a, b, c = np.moveaxis(corners_mm - point, 1, 0)
        one, two, three = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        triple = np.einsum("ij,ij->i", a, np.cross(b, c))
        ab, bc, ca = (np.einsum("ij,ij->i", x, y) for x, y in ((a, b), (b, c), (c, a)))
        below = one * two * three + ab * three + bc * one + ca * two
        found[row] = np.arctan2(triple, below).sum() / (2.0 * np.pi)
    return found
