"""How much each of a face's points counts, where points along edges come beside even ones.

Source: closed form derived here: an even point stands for one square of the spacing; it shares that
with the points along edges that lie nearest to it.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

__all__ = ["shared_weights"]


def shared_weights(even_mm: np.ndarray, beside_mm: np.ndarray) -> np.ndarray:
    """Weights of even points (N, 3) and of those beside them (M, 3); (N + M,), N in all.

    Without even points the others share the weight of one.
    """
    if not len(beside_mm):
        return np.ones(len(even_mm))
    if not len(even_mm):
        return np.full(len(beside_mm), 1.0 / len(beside_mm))
    nearest = cKDTree(even_mm).query(beside_mm)[1]
    weight = 1.0 / (1.0 + np.bincount(nearest, minlength=len(even_mm)))
    return np.r_[weight, weight[nearest]]
