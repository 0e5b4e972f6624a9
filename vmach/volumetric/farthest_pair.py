"""The two error vectors that differ most: the diameter of a set of points, exactly.

Both ends of a diameter are corners of the convex hull, so n (n - 1) / 2 comparisons shrink to
those among a few hundred corners. Large sets are thinned first: what lies inside a polytope
spanned by some of the points is no corner.

Source: closed form derived here: |u - v| is convex in u and in v, so that corners of the hull
attain its maximum.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy.spatial import ConvexHull

from stock.threads import run_in_parts

__all__ = ["corners_of_hull", "farthest_pair"]

_THIN_ABOVE = 20_000  #: hulls of fewer points take less time than thinning them
_FLAT = 1e-9  #: extent below this share of the largest is no dimension
_SAMPLE = 200_000  #: enough points to find a polytope that nearly fills the hull
_DIRECTIONS = (26, 290)  #: of the two polytopes that thin a large set


def farthest_pair(vectors: np.ndarray) -> tuple[int, int, float]:
    """Indices and distance of the two vectors that are farthest apart.

    Parameters
    ----------
    vectors : (P, 3) float64
        Any unit; P >= 1. For P = 1 both indices are 0.

    Returns
    -------
    first, second : int
        ``first <= second``.
    distance : float
    """
    vectors = np.ascontiguousarray(vectors, dtype=float)
    corners = corners_of_hull(vectors)
    first, second, square = _farthest(np.ascontiguousarray(vectors[corners]))
    pair = sorted((int(corners[first]), int(corners[second])))
    return pair[0], pair[1], float(np.sqrt(square))


def corners_of_hull(vectors: np.ndarray) -> np.ndarray:
    """Indices of vectors (P, 3) that hold all corners of their convex hull."""
    vectors = np.ascontiguousarray(vectors, dtype=float)
    candidates = np.arange(len(vectors))
    for count in _DIRECTIONS if len(vectors) > _THIN_ABOVE else ():
        candidates = candidates[_not_inside(vectors[candidates], _directions(count))]
    return candidates[_corners(vectors[candidates])]


def _directions(count: int) -> np.ndarray:
    """Unit vectors spread evenly over the sphere (golden spiral), (count, 3)."""
    z = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = np.pi * (3.0 - np.sqrt(5.0)) * np.arange(count)
    radius = np.sqrt(1.0 - z * z)
    return np.column_stack((radius * np.cos(turn), radius * np.sin(turn), z))


def _not_inside(points: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Mask of the points that are not inside a polytope spanned by some extreme ones."""
    some = points[:: max(1, len(points) // _SAMPLE)]
    if not _spans_space(some):
        return np.ones(len(points), dtype=bool)
    # directions in the shape of the cloud, which may be long and thin
    spread = np.linalg.cholesky(np.cov(some.T))
    extremes = some[np.unique(_extremes(some, np.linalg.solve(spread.T, directions.T).T.copy()))]
    if not _spans_space(extremes):
        return np.ones(len(points), dtype=bool)
    planes = np.unique(ConvexHull(extremes).equations, axis=0)
    margin = _FLAT * np.ptp(some, axis=0).max()
    return _outside(points, np.ascontiguousarray(planes), margin)


def _spans_space(points: np.ndarray) -> bool:
    values = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return len(values) == 3 and values[2] > _FLAT * values[0]


def _corners(points: np.ndarray) -> np.ndarray:
    """Indices of points that hold all corners of the convex hull, in as many dimensions as the
    set has."""
    if len(points) < 5:
        return np.arange(len(points))
    centred = points - points.mean(axis=0)
    along = centred @ np.linalg.svd(centred, full_matrices=False)[2].T
    extent = np.ptp(along, axis=0)
    dimensions = int(np.count_nonzero(extent > _FLAT * extent.max()))
    if dimensions == 0:
        return np.array([0])
    if dimensions == 1:
        return np.array([along[:, 0].argmin(), along[:, 0].argmax()])
    return ConvexHull(along[:, :dimensions]).vertices


def _extremes(points: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Index of the farthest point along each direction."""
    found = np.zeros(len(directions), dtype=np.int64)
    run_in_parts(
        lambda begin, end: _fill_extremes(points, directions, (begin, end), found),
        len(directions),
        least=1,
    )
    return found


@njit(cache=True, nogil=True)
def _fill_extremes(points, directions, part, found):
    for d in range(part[0], part[1]):
        best = -np.inf
        for p in range(len(points)):
            along = (
                points[p, 0] * directions[d, 0]
                + points[p, 1] * directions[d, 1]
                + points[p, 2] * directions[d, 2]
            )
            if along > best:
                best = along
                found[d] = p


def _outside(points: np.ndarray, planes: np.ndarray, margin: float) -> np.ndarray:
    """Whether a point is outside or within `margin` of any plane ``n x + d <= 0``."""
    result = np.zeros(len(points), dtype=np.bool_)
    run_in_parts(
        lambda begin, end: _fill_outside(points, planes, margin, (begin, end), result),
        len(points),
    )
    return result


@njit(cache=True, nogil=True)
def _fill_outside(points, planes, margin, part, result):
    for p in range(part[0], part[1]):
        x, y, z = points[p]
        for k in range(len(planes)):
            side = planes[k, 0] * x + planes[k, 1] * y + planes[k, 2] * z + planes[k, 3]
            if side > -margin:
                result[p] = True
                break


@njit(cache=True)
def _farthest(points):
    """All pairs: indices and squared distance of the farthest."""
    best, first, second = 0.0, 0, 0
    for i in range(len(points)):
        for j in range(i + 1, len(points)):
            square = 0.0
            for k in range(3):
                square += (points[i, k] - points[j, k]) ** 2
            if square > best:
                best, first, second = square, i, j
    return first, second, best
