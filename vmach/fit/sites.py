"""Readings taken again where others were: they have the same signatures, and are pooled.

Whatever effects and members do is the same in all readings of a site. In unit noise their columns
span few directions, block by block of what is correlated; with what differs among the readings of
a site, the readings themselves among it, an orthonormal basis of these keeps every product.

Source: derived here: products of columns are those of their coordinates in an orthonormal basis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array

from vmach.base.alike_rows import alike_rows
from vmach.fit.noise.feature_noise import FeatureNoise
from vmach.fit.whitening import orthonormal

__all__ = ["Pooled", "Sites", "sites_of"]

#: readings a site from which on pooling them is worth its bookkeeping
_WORTH = 2.0
#: share of a column that arithmetic rounds
_ROUNDING = 1e-12
#: readings that are compared together, so few that they stay near the processor
_AT_ONCE = 500


@dataclass(frozen=True, eq=False)
class Sites:
    """Which of n readings were taken at which of m sites.

    Attributes
    ----------
    first : (m,) int
        The first reading of each.
    of : (n,) int
        The site of each reading.
    """

    first: np.ndarray
    of: np.ndarray

    def is_constant(self, columns: np.ndarray) -> np.ndarray:
        """Whether columns (n, k) are the same in all readings of a site, (k,) bool."""
        apart, size = np.zeros((2, columns.shape[1]))
        for k in range(0, len(columns), _AT_ONCE):
            rows = columns[k : k + _AT_ONCE]
            change = rows - columns[self.first[self.of[k : k + _AT_ONCE]]]
            np.maximum(apart, np.abs(change).max(axis=0), out=apart)
            np.maximum(size, np.abs(rows).max(axis=0), out=size)
        return apart <= _ROUNDING * size


def sites_of(alike: Sequence[np.ndarray]) -> Sites | None:
    """Sites of readings of which some values (n, ...) are alike; None where few are repeated."""
    first, of = alike_rows(alike)
    return Sites(first, of) if len(of) >= _WORTH * len(first) else None


@dataclass(frozen=True, eq=False)
class Pooled:
    """Readings in unit noise, by r coordinates.

    Parameters
    ----------
    noise : FeatureNoise
        Of the n readings.
    sites : Sites
    others : (n, x) float64
        Columns in mm that differ among the readings of a site.

    Attributes
    ----------
    of_sites : (r, m) sparse
        Of columns that are given at every site.
    """

    noise: FeatureNoise
    sites: Sites
    others: np.ndarray
    of_sites: csr_array = field(init=False, repr=False)
    _of_readings: csr_array = field(init=False, repr=False)
    _basis: csr_array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        of_sites, of_readings, basis = _Blocks(), _Blocks(), _Blocks()
        end = 0
        for rows, root in self.noise.blocks(self.sites.of):
            here, number = np.unique(self.sites.of[rows], return_inverse=True)
            inside = root @ np.eye(len(here))[number]
            own = self.others[rows]
            own = root @ own[:, np.abs(own).max(axis=0, initial=0.0) > 0.0]
            space = orthonormal(inside)
            space = np.hstack([space, orthonormal(_beside(space, own))])
            coordinates = end + np.arange(space.shape[1])
            end += space.shape[1]
            of_sites.add(coordinates, here, space.T @ inside)
            of_readings.add(coordinates, rows, space.T @ root)
            basis.add(rows, coordinates, space)
        count, many = len(self.sites.of), len(self.sites.first)
        object.__setattr__(self, "of_sites", of_sites.whole((end, many)))
        object.__setattr__(self, "_of_readings", of_readings.whole((end, count)))
        object.__setattr__(self, "_basis", basis.whole((count, end)))

    @property
    def log_determinant(self) -> float:
        """Of the covariance of the readings, in units of u."""
        return self.noise.log_determinant

    def white(self, columns: np.ndarray) -> np.ndarray:
        """Columns (n, k) or (m, k) mm, given at every reading or site, in unit noise, (r, k)."""
        if len(columns) == len(self.sites.first):
            return self.of_sites @ columns
        return self._of_readings @ columns

    def back(self, white: np.ndarray) -> np.ndarray:
        """Columns (r, k) by the transpose of the map of columns at sites, (m, k)."""
        return self.of_sites.T @ white

    def spread(self, white: np.ndarray) -> np.ndarray:
        """Columns (r,) or (r, k) as every reading has them, in unit noise."""
        return self._basis @ white


def _beside(space: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """What an orthonormal basis leaves of columns, as far as it is more than rounding."""
    left = columns - space @ (space.T @ columns)
    left -= space @ (space.T @ left)
    notable = np.linalg.norm(left, axis=0) > _ROUNDING * np.linalg.norm(columns, axis=0)
    return left[:, notable]


class _Blocks:
    """Blocks of a sparse matrix."""

    def __init__(self) -> None:
        self._parts: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []

    def add(self, rows: np.ndarray, columns: np.ndarray, block: np.ndarray) -> None:
        """A block at given rows (a,) and columns (b,), of shape (a, b)."""
        row, column = np.meshgrid(rows, columns, indexing="ij")
        self._parts.append((block.ravel(), row.ravel(), column.ravel()))

    def whole(self, shape: tuple[int, int]) -> csr_array:
        """All blocks."""
        value, row, column = (np.concatenate(part) for part in zip(*self._parts, strict=True))
        return csr_array((value, (row, column)), shape=shape)
