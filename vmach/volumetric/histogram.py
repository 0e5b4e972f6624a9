"""Distribution of the differences between all pairs of error vectors.

Source: Huddersfield paper, section 4.1 (all n (n - 1) / 2 pairs).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from stock.threads import run_in_parts

__all__ = ["difference_histogram"]

_MOST_POINTS = 10_000  #: beyond that, this many are drawn by chance
_SEED = 230
_SHARES = 32  #: of the first indices, that threads work on


def difference_histogram(
    vectors: np.ndarray, largest: float, bins: int = 50
) -> tuple[np.ndarray, np.ndarray, int]:
    """Histogram of |v_i - v_j| over all pairs.

    Parameters
    ----------
    vectors : (P, 3) float64
        With more than 10 000 of them, 10 000 are drawn with a fixed seed.
    largest : float
        Upper end of the histogram: the largest difference.
    bins : int

    Returns
    -------
    edges : (bins + 1,) float64
    counts : (bins,) int64
    points : int
        Vectors whose pairs were counted.
    """
    vectors = np.asarray(vectors, dtype=float)
    if len(vectors) > _MOST_POINTS:
        chosen = np.random.default_rng(_SEED).choice(len(vectors), _MOST_POINTS, replace=False)
        vectors = vectors[np.sort(chosen)]
    edges = np.linspace(0.0, largest if largest > 0 else 1.0, bins + 1)
    counts = _counts(np.ascontiguousarray(vectors), edges[-1], bins)
    return edges, counts, len(vectors)


def _counts(vectors: np.ndarray, largest: float, bins: int) -> np.ndarray:
    """Pairs by length of their difference, (bins,)."""
    counts = np.zeros((_SHARES, bins), dtype=np.int64)
    run_in_parts(
        lambda begin, end: _fill_counts(vectors, largest, (begin, end), counts), _SHARES, least=1
    )
    return counts.sum(axis=0)


@njit(cache=True, nogil=True)
def _fill_counts(vectors, largest, part, counts):
    """One row for every share of the first indices, which are dealt out one by one."""
    shares, bins = counts.shape
    for share in range(part[0], part[1]):
        for i in range(share, len(vectors), shares):
            for j in range(i + 1, len(vectors)):
                dx = vectors[i, 0] - vectors[j, 0]
                dy = vectors[i, 1] - vectors[j, 1]
                dz = vectors[i, 2] - vectors[j, 2]
                length = np.sqrt(dx * dx + dy * dy + dz * dz)
                counts[share, min(int(length / largest * bins), bins - 1)] += 1
