"""Choose points that keep a distance from each other, and from edges.

Source: closed form derived here: each point is kept that is far enough from all that were kept
before it.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

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
    start, along = segments_mm[:, 0], segments_mm[:, 1] - segments_mm[:, 0]
    reach = np.linalg.norm(along, axis=1) / 2.0 + distance_mm
    hits = cKDTree(points_mm).query_ball_point(start + along / 2.0, reach)
    counts = [len(hit) for hit in hits]
    if not any(counts):
        return near
    point = np.concatenate([hit for hit in hits if hit]).astype(np.int64)
    segment = np.repeat(np.arange(len(segments_mm)), counts)
    offset = points_mm[point] - start[segment]
    square = np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)[segment]
    share = np.clip(np.einsum("ij,ij->i", offset, along[segment]) / square, 0.0, 1.0)
    apart = np.linalg.norm(offset - share[:, None] * along[segment], axis=1)
    near[point[apart < distance_mm]] = True
    return near
