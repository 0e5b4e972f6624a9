"""Slow random wandering, as a sum of independent waves of unit variance.

Source: C. Rasmussen and C. Williams, Gaussian Processes for Machine Learning (2006), eq. 4.17.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

__all__ = ["wandering"]

_MOST_KNOTS = 60


def wandering(position: np.ndarray, length: float) -> np.ndarray:
    """Columns W (P, K) such that W W^T is the covariance of a process that wanders.

    The covariance is (1 + d) exp(-d), d = sqrt(3) distance / length (Matern 3/2: bends may be
    sharp); the process is linear between knots a third of the length apart. There are 60 knots at
    most: of more than 20 lengths the variance between them falls to a half, and neighbours have
    more in common.
    """
    low, high = float(position.min()), float(position.max())
    knots, root = _root(low, high, length)
    # of the two knots around, each as far as it is near
    left = np.clip(np.searchsorted(knots, position, side="right") - 1, 0, len(knots) - 2)
    share = (position - knots[left]) / (knots[left + 1] - knots[left])
    return (1.0 - share)[:, None] * root[left] + share[:, None] * root[left + 1]


@lru_cache(maxsize=64)
def _root(low: float, high: float, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Knots (K,) between two ends, and a root (K, K) of the covariance there."""
    count = int(min(2 + np.ceil(3.0 * (high - low) / length), _MOST_KNOTS))
    knots = np.linspace(low, max(high, low + 1e-9), count)
    apart = np.sqrt(3.0) * np.abs(np.subtract.outer(knots, knots)) / length
    values, vectors = np.linalg.eigh((1.0 + apart) * np.exp(-apart))
    return knots, vectors * np.sqrt(np.maximum(values, 0.0))
