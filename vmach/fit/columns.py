"""Columns over the readings of a base, with their products: what a fit knows of a signature.

Whitening and the products with the members are worked out once for a signature; sums of columns
need no further pass over the members.

Source: derived here, from the products of linear least squares.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

__all__ = ["Columns"]


@dataclass(frozen=True, eq=False)
class Columns:
    """K columns, each together in memory.

    Attributes
    ----------
    make_mm, make_white : callable
        What they are, (n, K): in mm, and in unit noise without what the nuisance can explain.
        Worked out when asked for, as most questions are answered by products. Where readings
        were pooled, one row a site, and one a coordinate.
    make_gram : callable
        Products of the white columns with each other, (K, K).
    cross : (q, K) float64
        With the members' columns.
    seen : (K,) float64
        With the readings.
    site : (n,) int or None
        Which row in mm each reading has, where readings were pooled.
    """

    make_mm: Callable[[], np.ndarray]
    make_white: Callable[[], np.ndarray]
    make_gram: Callable[[], np.ndarray]
    cross: np.ndarray
    seen: np.ndarray
    site: np.ndarray | None = None

    @classmethod
    def of(
        cls,
        mm: Callable[[], np.ndarray],
        white: np.ndarray,
        cross: np.ndarray,
        seen: np.ndarray,
        site: np.ndarray | None = None,
    ) -> Self:
        """White columns (n, K) that are there."""
        return cls(mm, lambda: white, lambda: white.T @ white, cross, seen, site)

    def __len__(self) -> int:
        return len(self.seen)

    @property
    def size(self) -> int:
        """Numbers that they take up, those in mm with them."""
        return 2 * self.white.size + self.cross.size

    @property
    def mm(self) -> np.ndarray:
        """In mm, (n, K)."""
        return self.make_mm() if self.site is None else self.make_mm()[self.site]

    @cached_property
    def white(self) -> np.ndarray:
        """In unit noise, (n, K)."""
        return self.make_white()

    @cached_property
    def gram(self) -> np.ndarray:
        """Products of the white columns with each other, (K, K)."""
        return self.make_gram()

    def times(self, matrix: np.ndarray) -> Self:
        """Sums of columns, by a matrix (K, m) of their weights."""
        mm, white = self.make_mm() @ matrix, (matrix.T @ self.white.T).T
        return self.of(lambda: mm, white, self.cross @ matrix, self.seen @ matrix, self.site)

    def scaled(self, widths: np.ndarray | float) -> Self:
        """Each column so many times, (K,)."""
        wide, mm, white = np.broadcast_to(widths, self.seen.shape), self.make_mm, self.make_white
        return type(self)(
            lambda: mm() * wide,
            lambda: (wide[:, None] * white().T).T,
            lambda: self.gram * wide * wide[:, None],
            self.cross * wide,
            self.seen * wide,
            self.site,
        )

    def beside(self, other: Self) -> Self:
        """These and others; what is known of their products is not worked out again."""
        if not (len(self) and len(other)):
            return self if len(self) else other

        def gram() -> np.ndarray:
            shared = self.white.T @ other.white
            return np.block([[self.gram, shared], [shared.T, other.gram]])

        return type(self)(
            _side_by_side([self.make_mm, other.make_mm]),
            _side_by_side([self.make_white, other.make_white]),
            gram,
            np.concatenate([self.cross, other.cross], axis=1),
            np.concatenate([self.seen, other.seen]),
            self.site,
        )

    def split(self, parts_mm: Sequence[np.ndarray]) -> list[Self]:
        """Those that make up parts (n, k) mm, which do not hold the memory of the others."""
        ends = np.cumsum([0, *(part.shape[1] for part in parts_mm)]).tolist()
        found = []
        for own, (low, high) in zip(parts_mm, itertools.pairwise(ends), strict=True):
            white, cross = self.white[:, low:high].copy("F"), self.cross[:, low:high].copy()
            found.append(self.of(_ready(own), white, cross, self.seen[low:high], self.site))
        return found

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Side by side; at least one part."""
        if len(parts) == 1:
            return parts[0]
        mm = _side_by_side([part.make_mm for part in parts])
        white = _side_by_side([part.make_white for part in parts])()
        cross = np.concatenate([part.cross for part in parts], axis=1)
        seen = np.concatenate([part.seen for part in parts])
        return cls.of(mm, white, cross, seen, parts[0].site)


def _side_by_side(parts: Sequence[Callable[[], np.ndarray]]) -> Callable[[], np.ndarray]:
    """Columns of all parts, each together in memory."""
    return lambda: np.concatenate([part().T for part in parts]).T


def _ready(columns: np.ndarray) -> Callable[[], np.ndarray]:
    return lambda: columns
