"""Modes of the lines of a program: each of the different ones is kept once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

__all__ = ["BlockModes", "LineModes"]


@dataclass(frozen=True)
class BlockModes:
    """Modes of one block that moves the axes.

    Attributes
    ----------
    unit_mm : float
    incremental : bool
        G91.
    absolute_centre : bool
        G90.1.
    left : bool
        The block stays as it is: its position is none of the part's (G53, G28, G30), or the
        control taps (G33.1).
    inverse_time : bool
        G93.
    plane : int
        1 XY, 2 YZ, 3 XZ.
    """

    unit_mm: float
    incremental: bool
    absolute_centre: bool
    left: bool
    inverse_time: bool
    plane: int


class LineModes(Mapping[int, BlockModes]):
    """Modes by 1-based line.

    Parameters
    ----------
    lines : (L,) int64
        Increasing.

    Attributes
    ----------
    lines : (L,) int64
    which : (L,) int32
        Of the different modes; -1 for lines that have none yet, which are not in the mapping.
    """

    def __init__(self, lines: np.ndarray) -> None:
        self.lines, self.which = lines, np.full(len(lines), -1, np.int32)
        self._number: dict[BlockModes, int] = {}

    def put(self, places: slice | int, modes: BlockModes) -> None:
        """Say the modes of some of `lines`, by their places there."""
        self.which[places] = self._number.setdefault(modes, len(self._number))

    def column(self, name: str, line: np.ndarray, other: float | bool) -> np.ndarray:
        """One of the modes for lines, (N,); `other` for those that are not in the mapping."""
        values = np.array([*(getattr(modes, name) for modes in self._number), other])
        return values[self._of(line)]

    def left_lines(self) -> np.ndarray:
        """Lines that stay as they are, (K,) int64."""
        return self.lines[self.column("left", self.lines, other=False)]

    def _of(self, line: np.ndarray) -> np.ndarray:
        """Number of the modes of lines, (N,); -1 for none."""
        if not len(self.lines):
            return np.full(len(line), -1)
        place = np.minimum(np.searchsorted(self.lines, line), len(self.lines) - 1)
        return np.where(self.lines[place] == line, self.which[place], -1)

    def __getitem__(self, line: int) -> BlockModes:
        """Modes of a line."""
        (number,) = self._of(np.array([line]))
        if number < 0:
            raise KeyError(line)
        return [*self._number][number]

    def __iter__(self) -> Iterator[int]:
        """Lines in order."""
        return iter(self.lines[self.which >= 0].tolist())

    def __len__(self) -> int:
        return int((self.which >= 0).sum())
