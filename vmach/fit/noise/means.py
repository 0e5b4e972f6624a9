"""Means of neighbouring readings: fewer of them to look candidates over, where readings are many.

Readings in unit noise are added within stretches of a feature, so that the sums have unit noise
again: the probability of these sums is that of a part of what was measured.

Source: derived here; sums of a set of readings are a linear map of them with orthonormal rows.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array

from vmach.fit.noise.feature_noise import FeatureNoise

__all__ = ["Means"]


@dataclass(frozen=True)
class Means:
    """The noise of m sums of n readings.

    Attributes
    ----------
    noise : FeatureNoise
        Of the n readings.
    many : int
        Neighbours in one sum, at most.
    """

    noise: FeatureNoise
    many: int
    _sums: csr_array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        count = len(self.noise.group)
        _, number = np.unique(self.noise.group, return_inverse=True)
        order = np.argsort(number, kind="stable")
        first = np.searchsorted(number[order], number[order])
        stretch = (np.arange(count) - first) // self.many
        names = number[order] * count + stretch
        _, row, size = np.unique(names, return_inverse=True, return_counts=True)
        weight = 1.0 / np.sqrt(size[row])
        object.__setattr__(self, "_sums", csr_array((weight, (row, order))))

    log_determinant = log_prior = 0.0

    def white(self, columns: np.ndarray) -> np.ndarray:
        """Columns (n, k) mm in unit noise, summed, (m, k)."""
        return self._sums @ self.noise.white(columns)
