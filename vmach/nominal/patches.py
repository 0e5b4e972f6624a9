"""A surface that nobody has meshed, drawn as a square at each of its points."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from vmach.nominal.part import Mesh

__all__ = ["patches"]

#: side of a square where there are no neighbours, mm
_ALONE_MM = 1.0
#: points that get a square; of more, some are taken in equal steps, and squares are larger
_MOST = 40_000


def patches(point_mm: np.ndarray, normal: np.ndarray) -> Mesh:
    """Squares square to the normals, as large as the points are apart in the median.

    Parameters
    ----------
    point_mm, normal : (P, 3) float64
        Points and unit normals.
    """
    step = -(-len(point_mm) // _MOST)
    if step > 1:
        point_mm, normal = point_mm[::step], normal[::step]
    side_mm = _ALONE_MM
    if len(point_mm) > 1:
        distance = cKDTree(point_mm).query(point_mm, k=2)[0][:, 1]
        side_mm = float(np.median(distance)) or _ALONE_MM
    one = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal), axis=1)])
    one *= 0.5 * side_mm / np.linalg.norm(one, axis=1, keepdims=True)
    two = np.cross(normal, one)
    corners = np.stack([-one - two, one - two, one + two, two - one], axis=1)
    vertices = (point_mm[:, None] + corners).reshape(-1, 3)
    first = 4 * np.arange(len(point_mm))[:, None, None]
    triangles = (first + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3)
    return Mesh(vertices, triangles, np.repeat(np.arange(len(point_mm)), 2))
