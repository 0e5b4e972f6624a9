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

#: share of the largest variance of columns that is none
_NOTHING = 1e-14


@dataclass(frozen=True, eq=False)
class Columns:
    """K columns, each together in memory.

    Attributes
    ----------
    make_mm : callable
        What they are in mm, (n, K), worked out when asked for.
    parts : tuple of ((r, k) float64, (k,) float64)
        The same in unit noise without what the nuisance can explain: columns that stand side by
        side, and how many times each is meant. Scaled columns share their memory.
    make_gram : callable
        Products of the white columns with each other, (K, K).
    cross : (q, K) float64
        With the members' columns.
    seen : (K,) float64
        With the readings.
    """

    make_mm: Callable[[], np.ndarray]
    parts: tuple[tuple[np.ndarray, np.ndarray], ...]
    make_gram: Callable[[], np.ndarray]
    cross: np.ndarray
    seen: np.ndarray

    @classmethod
    def of(
        cls, mm: Callable[[], np.ndarray], white: np.ndarray, cross: np.ndarray, seen: np.ndarray
    ) -> Self:
        """White columns (r, K) that are there."""
        once = np.ones(white.shape[1])
        return cls(mm, ((white, once),), lambda: white.T @ white, cross, seen)

    def __len__(self) -> int:
        return len(self.seen)

    @property
    def size(self) -> int:
        """Numbers that they take up, those in mm with them."""
        return 2 * sum(white.size for white, _ in self.parts) + self.cross.size

    @property
    def mm(self) -> np.ndarray:
        """In mm, (n, K)."""
        return self.make_mm()

    @property
    def white(self) -> np.ndarray:
        """In unit noise, (r, K), put together."""
        if len(self.parts) == 1 and np.all(self.parts[0][1] == 1.0):
            return self.parts[0][0]
        return np.concatenate([wide[:, None] * white.T for white, wide in self.parts]).T

    @cached_property
    def gram(self) -> np.ndarray:
        """Products of the white columns with each other, (K, K)."""
        return self.make_gram()

    def told_apart(self) -> Self:
        """Products of the same covariance by as few columns as differ; the columns are not made."""
        squared, axes = np.linalg.eigh(self.gram)
        there = squared > _NOTHING * squared[-1:].max(initial=0.0)
        axes, gram = axes[:, there], np.diag(squared[there])
        cross, seen = self.cross @ axes, self.seen @ axes
        return type(self)(lambda: self.make_mm() @ axes, (), lambda: gram, cross, seen)

    def dot(self, white: np.ndarray) -> np.ndarray:
        """Products with other white columns (r, m), (K, m)."""
        return np.concatenate([wide[:, None] * (own.T @ white) for own, wide in self.parts])

    def dot_with(self, other: Self) -> np.ndarray:
        """Products with other columns, M of them, (K, M)."""
        return np.concatenate([self.dot(white) * wide for white, wide in other.parts], axis=1)

    def summed(self, amounts: np.ndarray) -> np.ndarray:
        """Sum of the white columns by amounts (K,) or (K, m), (r,) or (r, m)."""
        ends = np.cumsum([len(wide) for _, wide in self.parts])[:-1]
        pairs = zip(self.parts, np.split(amounts, ends), strict=True)
        first, *others = (white @ (wide * own.T).T for (white, wide), own in pairs)
        return sum(others, first)

    def times(self, matrix: np.ndarray) -> Self:
        """Sums of columns, by a matrix (K, m) of their weights."""
        mm, white = self.make_mm() @ matrix, (matrix.T @ self.white.T).T
        return self.of(lambda: mm, white, self.cross @ matrix, self.seen @ matrix)

    def scaled(self, widths: np.ndarray | float) -> Self:
        """Each column so many times, (K,)."""
        wide, mm = np.broadcast_to(widths, self.seen.shape), self.make_mm
        ends = np.cumsum([len(own) for _, own in self.parts])[:-1]
        pairs = zip(self.parts, np.split(wide, ends), strict=True)
        return type(self)(
            lambda: mm() * wide,
            tuple((white, before * own) for (white, before), own in pairs),
            lambda: self.gram * wide * wide[:, None],
            self.cross * wide,
            self.seen * wide,
        )

    def beside(self, other: Self) -> Self:
        """These and others; what is known of their products is not worked out again."""
        if not (len(self) and len(other)):
            return self if len(self) else other

        def gram() -> np.ndarray:
            shared = self.dot_with(other)
            return np.block([[self.gram, shared], [shared.T, other.gram]])

        return type(self)(
            _side_by_side([self.make_mm, other.make_mm]),
            (*self.parts, *other.parts),
            gram,
            np.concatenate([self.cross, other.cross], axis=1),
            np.concatenate([self.seen, other.seen]),
        )

    def split(self, parts_mm: Sequence[np.ndarray]) -> list[Self]:
        """Those that make up parts (n, k) mm, which do not hold the memory of the others."""
        ends = np.cumsum([0, *(part.shape[1] for part in parts_mm)]).tolist()
        found, whole = [], self.white
        for own, (low, high) in zip(parts_mm, itertools.pairwise(ends), strict=True):
            white, cross = whole[:, low:high].copy("F"), self.cross[:, low:high].copy()
            found.append(self.of(_ready(own), white, cross, self.seen[low:high]))
        return found

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """Side by side in memory; at least one part."""
        if len(parts) == 1:
            return parts[0]
        mm = _side_by_side([part.make_mm for part in parts])
        white = np.concatenate([part.white.T for part in parts]).T
        cross = np.concatenate([part.cross for part in parts], axis=1)
        seen = np.concatenate([part.seen for part in parts])
        return cls.of(mm, white, cross, seen)


def _side_by_side(parts: Sequence[Callable[[], np.ndarray]]) -> Callable[[], np.ndarray]:
    """Columns of all parts, each together in memory."""
    return lambda: np.concatenate([part().T for part in parts]).T


def _ready(columns: np.ndarray) -> Callable[[], np.ndarray]:
    return lambda: columns
