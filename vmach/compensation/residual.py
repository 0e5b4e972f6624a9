"""Distance of the tool from its nominal path.

Source: closed form derived here: distance of a point from a line or from a helix.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.program_text import Expanded

__all__ = ["Residual"]


@dataclass(frozen=True)
class Residual:
    """Distance of the tool from its nominal path while it cuts, mm.

    The full vector counts at programmed points, across the path between them.

    Attributes
    ----------
    line : (L,) int64
        Lines of the program, increasing.
    distance_mm : (L,) float64
        Largest distance of each.
    mean_mm : float
        Over all places; 0 without any.
    """

    line: np.ndarray
    distance_mm: np.ndarray
    mean_mm: float

    @classmethod
    def of(cls, distance_mm: np.ndarray, line: np.ndarray) -> Residual:
        """Of P places, (P,) mm, and their lines, (P,)."""
        mean_mm = float(distance_mm.mean()) if len(distance_mm) else 0.0
        return cls._by_line(distance_mm, line, mean_mm)

    @classmethod
    def _by_line(cls, distance_mm: np.ndarray, line: np.ndarray, mean_mm: float) -> Residual:
        largest = np.full(line.max(initial=0) + 1, -1.0)
        np.maximum.at(largest, line, distance_mm)
        lines = np.flatnonzero(largest >= 0.0)
        return cls(lines, largest[lines], mean_mm)

    def told_in(self, expansion: Expanded) -> Residual:
        """The same by the lines of the user's program."""
        return self._by_line(self.distance_mm, expansion.user_line(self.line), self.mean_mm)

    @property
    def largest_mm(self) -> float:
        """Largest distance; 0 without any."""
        return float(self.distance_mm.max(initial=0.0))

    def lines_beyond(self, limit_mm: float) -> dict[int, float]:
        """Largest distance of every line that is farther off, mm."""
        far = self.distance_mm > limit_mm
        return dict(zip(self.line[far].tolist(), self.distance_mm[far].tolist(), strict=True))
