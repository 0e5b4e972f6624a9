"""Pieces of compensated motion: blocks of the new program on stretches of the old one's moves."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import astuple, dataclass, fields

import numpy as np

from vmach.program_text.blocks.circles import circle_centre

__all__ = ["Piece", "Pieces", "circle_through"]


@dataclass(frozen=True)
class Piece:
    """One block of the compensated program.

    Attributes
    ----------
    move : int
        Row of the nominal moves.
    start, end : float
        Stretch of that move, 0 to 1; equal for a step that takes up a jump of the error.
    is_arc : bool
    kept : bool
        The block stays as it is.
    settled : float
        Of a step: where on the move the error that it answers is there in full.
    """

    move: int
    start: float
    end: float
    is_arc: bool = False
    kept: bool = False
    settled: float = 0.0

    @property
    def is_step(self) -> bool:
        """No way along the nominal path, only a jump of the correction."""
        return self.start == self.end


@dataclass(frozen=True)
class Pieces:
    """Pieces of a whole program as columns, (K,) each; see `Piece`.

    Attributes
    ----------
    move : int64
    start, end : float64
    is_arc, kept : bool
    settled : float64
    """

    move: np.ndarray
    start: np.ndarray
    end: np.ndarray
    is_arc: np.ndarray
    kept: np.ndarray
    settled: np.ndarray

    @classmethod
    def of(cls, pieces: Iterable[Piece]) -> Pieces:
        """Columns of single pieces."""
        rows = [astuple(piece) for piece in pieces]
        kinds = (np.int64, np.float64, np.float64, bool, bool, np.float64)
        columns = zip(*rows, strict=True) if rows else [()] * len(kinds)
        return cls(*(np.array(c, kind) for c, kind in zip(columns, kinds, strict=True)))

    @classmethod
    def joined(cls, parts: Iterable[Pieces]) -> Pieces:
        """Several one behind the other."""
        parts = list(parts)
        return cls(*(np.concatenate([getattr(part, f.name) for part in parts])
                     for f in fields(cls)))  # fmt: skip

    def __len__(self) -> int:
        return len(self.move)

    def __getitem__(self, index: int) -> Piece:
        return Piece(*(getattr(self, f.name)[index].item() for f in fields(self)))

    def __iter__(self) -> Iterator[Piece]:
        return map(Piece, *(getattr(self, f.name).tolist() for f in fields(self)))

    def taken(self, rows: np.ndarray) -> Pieces:
        """Some of them."""
        return Pieces(*(getattr(self, f.name)[rows] for f in fields(self)))

    @property
    def is_step(self) -> np.ndarray:
        """No way along the nominal path, only a jump of the correction, (K,) bool."""
        return self.start == self.end


def circle_through(first: np.ndarray, middle: np.ndarray, last: np.ndarray) -> np.ndarray | None:
    """Centre (2,) of the circle through three points of a plane; None where they are in line."""
    found, x, y = circle_centre(first, middle, last)
    return np.array([x, y]) if found else None
