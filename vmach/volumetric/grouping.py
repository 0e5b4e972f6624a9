"""The grouping of the Huddersfield paper: fewer comparisons, no guarantee.

Error vectors of similar direction form groups, and in each group those are dismissed that are
much shorter than the longest. Kept beside the exact `farthest_pair` for comparison.

Source: Huddersfield paper, section 4.2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from vmach.volumetric.farthest_pair import farthest_pair

__all__ = ["Grouping", "comparisons", "group_vectors"]


@dataclass(frozen=True)
class Grouping:
    """Result of the grouping method.

    Attributes
    ----------
    kept : (N,) int64
        Indices of the vectors that are left.
    comparisons : int
        Pairs among them.
    largest_difference : float
        Between any two that are left, unit of the vectors.
    """

    kept: np.ndarray
    comparisons: int
    largest_difference: float


def comparisons(count: int) -> int:
    """Pairs among `count` vectors."""
    return count * (count - 1) // 2


def group_vectors(
    vectors: np.ndarray, angular_tolerance: float, magnitude_tolerance: float = 0.9
) -> Grouping:
    """Group vectors by direction and keep the long ones of each group (section 4.1).

    Parameters
    ----------
    vectors : (P, 3) float64
    angular_tolerance : float
        A vector joins a group when the absolute differences between its unit vector and the
        group's mean add up to less than this.
    magnitude_tolerance : float
        A vector is dismissed when it is shorter than this share of the longest of its group.
    """
    vectors = np.ascontiguousarray(vectors, dtype=float)
    length = np.linalg.norm(vectors, axis=1)
    unit = vectors / np.where(length > 0, length, 1.0)[:, None]
    group, longest = _assign(unit, length, angular_tolerance)
    kept = np.flatnonzero(length >= magnitude_tolerance * longest[group])
    return Grouping(kept, comparisons(len(kept)), farthest_pair(vectors[kept])[2])


@njit(cache=True)
def _assign(unit, length, tolerance):
    """Group of every vector, first fit, and the longest length of every group."""
    count = len(unit)
    total = np.zeros((count, 3))
    members = np.zeros(count)
    longest = np.zeros(count)
    group = np.zeros(count, dtype=np.int64)
    groups = 0
    for p in range(count):
        chosen = groups
        for g in range(groups):
            difference = 0.0
            for k in range(3):
                difference += abs(unit[p, k] - total[g, k] / members[g])
            if difference < tolerance:
                chosen = g
                break
        if chosen == groups:
            groups += 1
        group[p] = chosen
        members[chosen] += 1.0
        total[chosen] += unit[p]
        longest[chosen] = max(longest[chosen], length[p])
    return group, longest[:groups]
