"""A table that grows by rows and by blocks of rows."""

from __future__ import annotations

import numpy as np

__all__ = ["Table"]


class Table:
    """Rows of `width` numbers; single ones wait as tuples until somebody asks for the whole."""

    def __init__(self, width: int) -> None:
        self._parts: list[np.ndarray] = [np.zeros((0, width))]
        self._waiting: list[tuple] = []

    def append(self, row: tuple) -> None:
        """Append one row."""
        self._waiting.append(row)

    def extend(self, rows: np.ndarray) -> None:
        """Append rows, (R, width) float64."""
        if len(rows):
            self._settle()
            self._parts.append(rows)

    def whole(self) -> np.ndarray:
        """All rows, (N, width) float64."""
        self._settle()
        if len(self._parts) > 1:
            self._parts = [np.concatenate(self._parts)]
        return self._parts[0]

    def _settle(self) -> None:
        if self._waiting:
            self._parts.append(np.array(self._waiting, np.float64))
            self._waiting = []
