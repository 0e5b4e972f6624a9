"""What the points of a surface ask of the path that makes them.

Source: closed form derived here: the shift -d n undoes a deviation d.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["SurfaceDemand", "made_by"]

#: numbers of moves are smaller
_MOVES = 1 << 32


def made_by(point: np.ndarray, move: np.ndarray) -> np.ndarray:
    """One number for every point and a move that makes it, (P,) int64."""
    return point * _MOVES + move


@dataclass(frozen=True)
class SurfaceDemand:
    """What P surface points ask of the path.

    Attributes
    ----------
    point : (P,) int64
        Numbers of the points; one that several moves make may ask each of them.
    move : (P,) int64
    parameter : (P,) float64
        Where on the nominal path each was made.
    normal : (P, 3) float64
        Outward.
    shift_mm : (P,) float64
        Shift along the normal that would leave no deviation.
    """

    point: np.ndarray
    move: np.ndarray
    parameter: np.ndarray
    normal: np.ndarray
    shift_mm: np.ndarray

    def beside(self, earlier: SurfaceDemand | None) -> SurfaceDemand:
        """These, and earlier ones of the same points to other moves.

        A move that no longer makes a point, because another one now goes deeper there, would
        take the point back if it were let go.
        """
        if earlier is None:
            return self
        now, before = (made_by(d.point, d.move) for d in (self, earlier))
        kept = ~np.isin(before, now)
        names = self.__dataclass_fields__
        return SurfaceDemand(
            *(np.concatenate([getattr(self, n), getattr(earlier, n)[kept]]) for n in names)
        )
