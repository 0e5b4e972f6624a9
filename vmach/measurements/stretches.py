"""Stretches of a surface that measured points lie on, where the file names no features.

Source: closed form derived here: points are of one stretch that a chain of near neighbours joins.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from vmach.base.alike_rows import alike_rows

__all__ = ["stretches_of"]

#: median distances of nearest neighbours within which points are near each other; chosen, so that
#: one point may be missing
_NEAR = 3.0
#: fewer points are no stretch of their own
_FEWEST = 3


def stretches_of(points_mm: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Name of the stretch of each point, (P,) str; points apart from all others share one.

    Neighbours are near each other, and their normals (P, 3) turn by less than 60 degrees.
    """
    # points that were measured again are no neighbours
    single, of = alike_rows([points_mm, normals])
    if len(single) < len(points_mm):
        return stretches_of(points_mm[single], normals[single])[of]
    if len(points_mm) < _FEWEST:
        return np.full(len(points_mm), "stretch 1")
    apart = cKDTree(points_mm).query(points_mm, k=2)[0][:, 1]
    near = max(_NEAR * float(np.median(apart)), 1e-6)
    # a chord between unit normals is one where they turn by 60 degrees
    pairs = cKDTree(np.hstack([points_mm / near, normals])).query_pairs(1.0, output_type="ndarray")
    joined = coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(len(points_mm),) * 2)
    _, number = connected_components(joined, directed=False)
    number[np.bincount(number)[number] < _FEWEST] = -1
    lone = np.flatnonzero(number == -1)
    names = np.char.mod("stretch %d", np.unique(number, return_inverse=True)[1] + 1)
    names[lone] = "alone"
    return names
