"""Choose points that keep a distance from each other, and from edges.

Source: closed form derived here: each point is kept that is far enough from all that were kept
before it.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from stock.compiled import njit_maker, njit_part

__all__ = ["near_segments", "spread"]


def spread(points_mm: np.ndarray, distance_mm: float) -> np.ndarray:
    """Mask, (P,), of points at least `distance_mm` apart such that every other has one nearer.

    A maximal independent set by fixed pseudo-random priorities, the same at every call.
    """
    count = len(points_mm)
    priority = np.random.default_rng(0).permutation(count)
    pairs = cKDTree(points_mm).query_pairs(distance_mm, output_type="ndarray")
    chosen, waiting = np.zeros(count, dtype=bool), np.ones(count, dtype=bool)
    while waiting.any():
        first, second = pairs.T
        best = np.full(count, -1)
        np.maximum.at(best, first, priority[second])
        np.maximum.at(best, second, priority[first])
        won = waiting & (priority > best)
        chosen |= won
        beaten = np.r_[second[won[first]], first[won[second]]]
        waiting &= ~won
        waiting[beaten] = False
        pairs = pairs[waiting[first] & waiting[second]]
    return chosen


def near_segments(points_mm: np.ndarray, segments_mm: np.ndarray, distance_mm: float) -> np.ndarray:
    """Mask of the points nearer than `distance_mm` to any of the segments (S, 2, 3)."""
    near = np.zeros(len(points_mm), dtype=bool)
    if not len(points_mm) or not len(segments_mm) or distance_mm <= 0.0:
        return near
    axis = int(np.argmax(np.ptp(points_mm, axis=0)))
    order = np.argsort(points_mm[:, axis])
    segments_mm = np.ascontiguousarray(segments_mm)
    near[order] = _near_segments(points_mm[order], segments_mm, float(distance_mm), axis)
    return near


@njit_maker()
def _near_segments(points_mm, segments_mm, distance_mm, axis):
    """Mask of the points, in the order of one coordinate, that are near to a segment."""
    ordered, near = points_mm[:, axis].copy(), np.zeros(len(points_mm), dtype=np.bool_)
    along = np.empty(3)
    for s in range(len(segments_mm)):
        start, end = segments_mm[s, 0], segments_mm[s, 1]
        square = 1e-300
        for k in range(3):
            along[k] = end[k] - start[k]
            square += along[k] ** 2
        n = np.searchsorted(ordered, min(start[axis], end[axis]) - distance_mm)
        highest = max(start[axis], end[axis]) + distance_mm
        while n < len(ordered) and ordered[n] <= highest:
            if not near[n]:
                near[n] = _apart_square(points_mm[n], start, along, square) < distance_mm**2
            n += 1
    return near


@njit_part()
def _apart_square(point, start, along, square):
    """Squared distance of a point from a segment, whose squared length is given."""
    share = 0.0
    for k in range(3):
        share += (point[k] - start[k]) * along[k]
    share = min(max(share / square, 0.0), 1.0)
    apart = 0.0
    for k in range(3):
        apart += (point[k] - start[k] - share * along[k]) ** 2
    return apart
