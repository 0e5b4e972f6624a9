"""Columns over the readings of a base, with their products: what a fit knows of a signature.

Whitening and the products with the members are worked out once for a signature; sums of columns
need no further pass over the members.

Source: derived here, from the products of linear least squares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

__all__ = ["Columns"]


@dataclass(frozen=True, eq=False)
class Columns:
    """K columns.

    Attributes
    ----------
    mm, white : (n, K) float64
        In mm, and in unit noise without what the nuisance can explain.
    cross : (q, K) float64
        Products with the members' columns.
    seen : (K,) float64
        With the readings.
    """

    mm: np.ndarray
    white: np.ndarray
    cross: np.ndarray
    seen: np.ndarray

    def __len__(self) -> int:
        return len(self.seen)

    @cached_property
    def gram(self) -> np.ndarray:
        """Products of the white columns with each other, (K, K)."""
        return self.white.T @ self.white

    @property
    def size(self) -> int:
        """Numbers of eight bytes that they take up."""
        return (self.mm.nbytes + self.white.nbytes + self.cross.nbytes) // 8

    def times(self, matrix: np.ndarray) -> Self:
        """Sums of columns, by a matrix (K, m) of their weights."""
        return type(self)(
            self.mm @ matrix, self.white @ matrix, self.cross @ matrix, self.seen @ matrix
        )

    def scaled(self, widths: np.ndarray | float) -> Self:
        """Each column so many times, (K,)."""
        mm, white, cross = self.mm * widths, self.white * widths, self.cross * widths
        return type(self)(mm, white, cross, self.seen * widths)

    def split(self, count: int) -> list[Self]:
        """So many equal parts, none of which holds the memory of the others.

        What they are in mm, which no product needs, is rounded.
        """
        if count == 1:
            return [self]
        parts = [np.hsplit(m, count) for m in (self.mm, self.white, self.cross)]
        seen = np.split(self.seen, count)
        return [
            type(self)(mm.astype(np.float32), white.copy(), cross.copy(), own)
            for mm, white, cross, own in zip(*parts, seen, strict=True)
        ]

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Side by side; at least one part."""
        if len(parts) == 1:
            return parts[0]
        mm, white, cross = (
            np.concatenate([getattr(p, name) for p in parts], axis=1)
            for name in ("mm", "white", "cross")
        )
        return cls(mm, white, cross, np.concatenate([p.seen for p in parts]))
