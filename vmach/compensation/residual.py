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

    Attributes
    ----------
    distance_mm : (P,) float64
        Full vector at programmed points, across the path between them.
    line : (P,) int64
        Line of the original program.
    """

    distance_mm: np.ndarray
    line: np.ndarray

    def told_in(self, expansion: Expanded) -> Residual:
        """The same by the lines of the user's program."""
        return Residual(self.distance_mm, expansion.user_line(self.line))

    @property
    def largest_mm(self) -> float:
        """Largest distance; 0 without any."""
        return float(self.distance_mm.max(initial=0.0))

    @property
    def mean_mm(self) -> float:
        """Mean distance; 0 without any."""
        return float(self.distance_mm.mean()) if len(self.distance_mm) else 0.0

    def lines_beyond(self, limit_mm: float) -> dict[int, float]:
        """Largest distance of every line that is farther off, mm."""
        lines, largest = self.by_line()
        far = largest > limit_mm
        return dict(zip(lines[far].tolist(), largest[far].tolist(), strict=True))

    def by_line(self) -> tuple[np.ndarray, np.ndarray]:
        """Lines, (L,) increasing, and the largest distance of each, (L,) mm."""
        lines, place = np.unique(self.line, return_inverse=True)
        largest = np.zeros(len(lines))
        np.maximum.at(largest, place, self.distance_mm)
        return lines, largest
