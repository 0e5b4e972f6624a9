"""Readings with correlated uncertainty and free nuisance, turned into plain unit noise.

Source: A. Aitken, Proc. R. Soc. Edinburgh 55 (1936) 42 (generalised least squares); closed form
derived here: 1 + F F^T has the root of its eigenvalues where F has columns, 1 elsewhere.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

__all__ = ["Whiten", "Whitening", "condensed", "orthonormal", "share_within", "thin_product"]

#: turns columns (n,) or (n, k) mm into plain unit noise
Whiten = Callable[[np.ndarray], np.ndarray]

#: share of the largest norm below which a direction counts as zero
_RANK = 1e-9
#: share of the largest norm that is what rounding leaves of a column which was taken out
_ROUNDING = 1e-12
#: a cause that adds less than this, in standard uncertainties, to any direction is left out: it
#: changes the variance there by less than one per cent
_NOTABLE = 0.1
#: columns that are multiplied one by one
_FEW = 4


def orthonormal(columns: np.ndarray, *, tolerance: float = _RANK) -> np.ndarray:
    """Orthonormal basis of the span of the columns, (n, r); what rounding left of one is none."""
    norm = np.linalg.norm(columns, axis=0)
    there = norm > _ROUNDING * norm.max(initial=0.0)
    if not there.any():
        return columns[:, :0]
    left, size, _ = np.linalg.svd(columns[:, there] / norm[there], full_matrices=False)
    return left[:, size > tolerance * max(size[0], 1e-300)]


def condensed(columns: np.ndarray, u: np.ndarray, *, least: float) -> np.ndarray:
    """The same covariance by fewer columns.

    Parameters
    ----------
    columns : (n, k) float64
    u : (n,) float64
        Standard uncertainty of each reading.
    least : float
        What adds less than this share of u² to any direction is left out.
    """
    scaled = columns / u[:, None]
    gram = scaled.T @ scaled
    del scaled  # columns may be many
    squared, vectors = np.linalg.eigh(gram)
    return columns @ vectors[:, squared > least]


class Whitening:
    """Maps readings so that noise of covariance diag(u^2) + F F^T becomes white.

    What the nuisance columns can explain is taken out afterwards, whatever its size: all later
    sums of squares are those of a generalised least-squares fit with the nuisance free.

    Parameters
    ----------
    u : (n,) float64
        Independent standard uncertainty of each reading.
    factors : (n, q) float64
        Signatures of the common causes, each of unit variance.
    nuisance : (n, p) float64
        Columns of what is free.
    """

    def __init__(self, u: np.ndarray, factors: np.ndarray, nuisance: np.ndarray) -> None:
        self._u = u[:, None]
        scaled = factors / self._u
        squared, vectors = np.linalg.eigh(scaled.T @ scaled)
        notable = squared > _NOTABLE**2
        self._left = scaled @ (vectors[:, notable] / np.sqrt(squared[notable]))
        self._shrink = 1.0 - 1.0 / np.sqrt(1.0 + squared[notable])
        self._free = orthonormal(self._white(nuisance))

    def __call__(self, columns: np.ndarray) -> np.ndarray:
        """Whitened columns without their nuisance part; (n,) or (n, k)."""
        flat = columns.reshape(len(columns), -1)
        white = self._white(flat)
        white -= self._free @ (self._free.T @ white)
        return white.reshape(columns.shape)

    def _white(self, columns: np.ndarray) -> np.ndarray:
        scaled = columns / self._u
        share = self._shrink[:, None] * thin_product(self._left.T, scaled)
        return scaled - thin_product(self._left, share)


def thin_product(matrix: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Matrix times (n, k); a few columns one by one, which BLAS does in half the time."""
    if 1 < columns.shape[1] <= _FEW:
        return np.stack([matrix @ column for column in columns.T], axis=1)
    return matrix @ columns


def share_within(space: np.ndarray, other: np.ndarray) -> float:
    """Which share of a space of readings lies within another one, as a cosine.

    Both are given by orthonormal columns, (n, r) and (n, s).
    """
    return float(np.linalg.norm(other.T @ space) / np.sqrt(max(space.shape[1], 1)))
