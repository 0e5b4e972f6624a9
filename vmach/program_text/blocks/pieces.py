"""Pieces of compensated motion: blocks of the new program on stretches of the old one's moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["Piece", "circle_through"]

#: a circle of larger radius is written as a line
_LARGEST_RADIUS_MM = 1e5


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


def circle_through(first: np.ndarray, middle: np.ndarray, last: np.ndarray) -> np.ndarray | None:
    """Centre (2,) of the circle through three points of a plane; None where they are in line."""
    a, b = middle - first, last - first
    twice_area = 2.0 * (a[0] * b[1] - a[1] * b[0])
    if abs(twice_area) * _LARGEST_RADIUS_MM <= abs(a @ a * np.linalg.norm(b)):
        return None
    x = (b[1] * (a @ a) - a[1] * (b @ b)) / twice_area
    y = (a[0] * (b @ b) - b[0] * (a @ a)) / twice_area
    return first + np.array([x, y])
