"""Rotation about Z and mirror images of X and Y: the turning part of a programmable frame.

Source: HEIDENHAIN TNC 640, User's Manual Cycle Programming (cycles 8 and 10); SINUMERIK 840D sl,
Programming Manual Fundamentals (ROT, MIRROR). A programmed point is mirrored, then turned,
then shifted. Z keeps its sense, so that the part is never turned over.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = ["FrameTurn"]


@dataclass(frozen=True)
class FrameTurn:
    """What becomes of X and Y before the frame's shift.

    Attributes
    ----------
    angle_deg : float
        Counter-clockwise about Z.
    signs : tuple of float
        -1.0 where X, or Y, is mirrored.
    """

    angle_deg: float = 0.0
    signs: tuple[float, float] = (1.0, 1.0)

    @property
    def is_identity(self) -> bool:
        """Neither turned nor mirrored."""
        return self.angle_deg == 0.0 and self.signs == (1.0, 1.0)

    @property
    def _angle(self) -> tuple[float, float]:
        quarter = self.angle_deg / 90.0
        if quarter == int(quarter):  # exact, so that a quarter turn leaves round numbers
            return ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))[int(quarter) % 4]
        angle = math.radians(self.angle_deg)
        return math.cos(angle), math.sin(angle)

    def matrix(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Rows of the 2 by 2 matrix."""
        cosine, sine = self._angle
        x, y = self.signs
        return (cosine * x, -sine * y), (sine * x, cosine * y)

    def apply(self, point: list[float]) -> list[float]:
        """Where a programmed point goes; all but X and Y stay."""
        if self.is_identity:
            return list(point)
        (a, b), (c, d) = self.matrix()
        x, y, *rest = point
        return [a * x + b * y, c * x + d * y, *rest]

    def undo(self, point: list[float]) -> list[float]:
        """The programmed point of one in the frame's base."""
        if self.is_identity:
            return list(point)
        (a, b), (c, d) = self.matrix()
        x, y, *rest = point
        return [a * x + c * y, b * x + d * y, *rest]

    def before(self, inner: FrameTurn) -> FrameTurn:
        """The turn that does `inner` first and then this one."""
        sense = self.signs[0] * self.signs[1]
        return FrameTurn(
            self.angle_deg + sense * inner.angle_deg,
            (self.signs[0] * inner.signs[0], self.signs[1] * inner.signs[1]),
        )
