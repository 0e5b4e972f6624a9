"""Noise of single readings: correlated along a feature, with heavy tails, up to one factor.

In units of the stated standard uncertainty u the covariance of the readings of one feature is

    C = (1 - s) diag(1 / w) + s r^|i - j|

with the share s that goes from point to point with the correlation r (stylus, form of the wall),
and weights w below one for readings that stand out from their neighbours: the mean of a
chi-squared mixture, with which a normal distribution becomes Student's t.

Source: K. Lange, R. Little and J. Taylor, J. Am. Stat. Assoc. 84 (1989) 881 (Student's t as a
mixture).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import solve_triangular

__all__ = ["FeatureNoise"]

#: readings whose covariance is worked out together; those further apart count as independent
_BLOCK = 128


@dataclass(frozen=True)
class FeatureNoise:
    """Covariance of n readings, block by block.

    Attributes
    ----------
    u_mm : (n,) float64
        Stated standard uncertainty.
    group : (n,) str
        Feature or run; readings follow each other within it.
    weight : (n,) float64
    share, correlation : float
        Of the variance that is correlated, and from one reading to the next.
    log_prior : float
        Log probability of the weights, as far as the covariance does not state it: readings
        weighed otherwise are compared with it.
    """

    u_mm: np.ndarray
    group: np.ndarray
    weight: np.ndarray
    share: float = 0.0
    correlation: float = 0.0
    log_prior: float = 0.0

    @property
    def is_plain(self) -> bool:
        """Whether every reading weighs as stated."""
        return bool(np.all(self.weight == 1.0))

    def is_as(self, other: FeatureNoise) -> bool:
        """Whether it is that of the same readings with the same weights and correlation."""
        same = np.array_equal(self.weight, other.weight) and self.share == other.share
        return same and self.correlation == other.correlation and self.u_mm is other.u_mm

    def white(self, columns: np.ndarray) -> np.ndarray:
        """Columns (n, k) mm in unit noise."""
        scaled = columns / self.u_mm[:, None]
        if self.share == 0.0:
            scaled *= np.sqrt(self.weight)[:, None]
            return scaled
        return self._by_blocks(scaled, [inverse for _, inverse in self._roots])

    def back(self, white: np.ndarray) -> np.ndarray:
        """Columns (n, k) by the transpose of the map that makes columns white."""
        if self.share == 0.0:
            return white * (np.sqrt(self.weight) / self.u_mm)[:, None]
        back = self._by_blocks(white, [inverse.T for _, inverse in self._roots])
        back /= self.u_mm[:, None]
        return back

    def deviations(self, weights: np.ndarray) -> np.ndarray:
        """Of weighted sums of readings, (n, k) mm: a column's squares add up to a variance."""
        scaled = weights * self.u_mm[:, None]
        if self.share == 0.0:
            return scaled / np.sqrt(self.weight)[:, None]
        return self._by_blocks(scaled, [root.T for root, _ in self._roots])

    def _by_blocks(self, columns: np.ndarray, matrices: Sequence[np.ndarray]) -> np.ndarray:
        """Columns (n, k), each block of readings times its matrix."""
        ordered = columns[self._order]
        found = np.empty_like(ordered)
        end = 0
        for matrix in matrices:
            start, end = end, end + len(matrix)
            np.matmul(matrix, ordered[start:end], out=found[start:end])
        ordered[self._order] = found
        return ordered

    def standardised(self, white: np.ndarray) -> np.ndarray:
        """The expected independent part of white readings (n,), in standard deviations."""
        if self.share == 0.0:
            return white / np.sqrt(self.weight)
        back = self.back(white[:, None])[:, 0] * self.u_mm
        return np.sqrt(1.0 - self.share) / self.weight * back

    @cached_property
    def precisions(self) -> np.ndarray:
        """Of every reading, given all others: the diagonal of the inverse, in units of u, (n,)."""
        if self.share == 0.0:
            return self.weight
        found = np.empty(len(self.weight))
        found[self._order] = np.concatenate([(i**2).sum(axis=0) for _, i in self._roots])
        return found

    @cached_property
    def log_determinant(self) -> float:
        """Of the covariance in units of u."""
        if self.share == 0.0:
            return -float(np.log(self.weight).sum())
        return 2.0 * float(sum(np.log(np.diag(root)).sum() for root, _ in self._roots))

    @cached_property
    def _roots(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Lower Cholesky factor of the covariance of each block, and its inverse."""
        found = []
        end = 0
        for size in self._sizes:
            start, end = end, end + size
            apart = np.abs(np.subtract.outer(np.arange(size), np.arange(size)))
            covariance = self.share * self.correlation**apart
            covariance[np.diag_indices(size)] += (1.0 - self.share) / self.weight[
                self._order[start:end]
            ]
            root = np.linalg.cholesky(covariance)
            found.append((root, solve_triangular(root, np.eye(size), lower=True)))
        return found

    @cached_property
    def _order(self) -> np.ndarray:
        """Readings feature by feature, (n,)."""
        return np.argsort(np.unique(self.group, return_inverse=True)[1], kind="stable")

    @cached_property
    def _sizes(self) -> list[int]:
        """Readings of each block, in that order; a feature has as few blocks as it can."""
        count = np.unique(self.group, return_counts=True)[1]
        parts = [np.array_split(np.arange(c), int(np.ceil(c / _BLOCK))) for c in count]
        return [len(block) for feature in parts for block in feature]
