"""Readings with correlated uncertainty and free nuisance, turned into plain unit noise.

Source: A. Aitken, Proc. R. Soc. Edinburgh 55 (1936) 42 (generalised least squares); closed form
derived here: 1 + F F^T has the root of its eigenvalues where F has columns, 1 elsewhere.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from vmach.fit.marginal_likelihood import Base, Sizes

__all__ = ["MemberWhitening", "Whitening", "orthonormal"]

#: share of the largest norm below which a direction counts as zero
_RANK = 1e-9
#: a cause that adds less than this, in standard uncertainties, to any direction is left out: it
#: changes the variance there by less than one per cent
_NOTABLE = 0.1
#: columns that are multiplied one by one
_FEW = 4


def orthonormal(columns: np.ndarray, *, tolerance: float = _RANK) -> np.ndarray:
    """Orthonormal basis of the span of the columns, (n, r)."""
    if columns.shape[1] == 0:
        return columns
    norm = np.linalg.norm(columns, axis=0)
    scaled = columns / np.where(norm > 0, norm, 1.0)
    left, size, _ = np.linalg.svd(scaled, full_matrices=False)
    return left[:, size > tolerance * max(size[0], 1e-300)]


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
    products : (q, q) float64, optional
        Of the factors in standard uncertainties with each other, where they are known.
    """

    def __init__(
        self,
        u: np.ndarray,
        factors: np.ndarray,
        nuisance: np.ndarray,
        *,
        products: np.ndarray | None = None,
    ) -> None:
        self._u = u[:, None]
        scaled = factors / self._u
        squared, vectors = np.linalg.eigh(scaled.T @ scaled if products is None else products)
        notable = squared > _NOTABLE**2
        self._left = scaled @ (vectors[:, notable] / np.sqrt(squared[notable]))
        self._shrink = 1.0 - 1.0 / np.sqrt(1.0 + squared[notable])
        self._free = orthonormal(self._white(nuisance))

    @property
    def degrees(self) -> int:
        """Degrees of freedom left after the nuisance."""
        return len(self._u) - self._free.shape[1]

    def __call__(self, columns: np.ndarray) -> np.ndarray:
        """Whitened columns without their nuisance part; (n,) or (n, k)."""
        flat = columns.reshape(len(columns), -1)
        return self.projected(self._white(flat)).reshape(columns.shape)

    def projected(self, white: np.ndarray) -> np.ndarray:
        """White readings (n, k) without what the nuisance can explain."""
        return white - self._free @ (self._free.T @ white)

    def _white(self, columns: np.ndarray) -> np.ndarray:
        scaled = columns / self._u
        share = self._shrink[:, None] * _product(self._left.T, scaled)
        return scaled - _product(self._left, share)


def _product(matrix: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Matrix times (n, k); a few columns one by one, which BLAS does in half the time."""
    if 1 < columns.shape[1] <= _FEW:
        return np.stack([matrix @ column for column in columns.T], axis=1)
    return matrix @ columns


class MemberWhitening:
    """Maps readings to plain unit noise, the members of a base counted at given sizes.

    Parameters
    ----------
    base : Base
        What turns readings into the units of their feature noise, nuisance projected out.
    sizes : Sizes
    more_mm : (n, k) float64, optional
        Signatures of unit variance that count as uncertainty too.
    """

    def __init__(self, base: Base, sizes: Sizes, more_mm: np.ndarray | None = None) -> None:
        self._base, self._sizes, self._more_mm = base, sizes, more_mm

    @cached_property
    def _white(self) -> Whitening:
        """Made when it is first asked for: many fits are kept that nobody asks again."""
        base, factor = self._base, self._sizes.factor
        scale = np.array([1.0, *self._sizes.members])[base.member_of] / factor
        members, products = base.z * scale, base.gram * scale * scale[:, None]
        if self._more_mm is not None:
            members = np.hstack([members, base.white(self._more_mm) / factor])
            products = None
        one, none = np.ones(len(members)), np.zeros((len(members), 0))
        return Whitening(one, members, none, products=products)

    def fresh(self) -> MemberWhitening:
        """The same, without what was worked out for it."""
        return MemberWhitening(self._base, self._sizes, self._more_mm)

    @property
    def degrees(self) -> int:
        """Degrees of freedom left after the nuisance."""
        return self._base.degrees

    def __call__(self, columns: np.ndarray) -> np.ndarray:
        """Whitened columns without their nuisance part; (n,), (n, k) or more."""
        flat = columns.reshape(len(columns), -1)
        return self._white(self._base.white(flat) / self._sizes.factor).reshape(columns.shape)
