"""What the kernels are asked about: one line and one piece of a sweep that it may meet.

Source: closed form derived here: names of `stock.exact.tool_distance` and
`stock.exact.sweep_distance`.
"""

from __future__ import annotations

from typing import NamedTuple

from stock.compiled import njit_inlined
from stock.exact.motion import Motion
from stock.exact.outline import Outlines

__all__ = ["TOUCH_MM", "Cut", "Meeting", "point_at"]

#: Nearer than this a sweep touches. Workpiece coordinates up to 1000 mm carry rounding of
#: 1e-13 mm, sums of a few of them 1e-12; 1e-9 mm keeps well clear of it and is a millionth
#: of a micrometre.
TOUCH_MM = 1e-9


class Cut(NamedTuple):
    """What cuts: the motion of all sweeps, and the outlines of their tools."""

    motion: Motion
    outlines: Outlines


class Meeting(NamedTuple):
    """A line and a piece of a sweep.

    Attributes
    ----------
    cut : Cut
    sweep : int
    span : tuple of float
        The piece of the sweep, as two values of s.
    line : tuple (p, n) of 3-tuples
        The points p + h n, n of unit length.
    """

    cut: Cut
    sweep: int
    span: tuple[float, float]
    line: tuple[tuple[float, float, float], tuple[float, float, float]]


@njit_inlined()
def point_at(line, h):
    """The line's point at h."""
    p, n = line
    return (p[0] + h * n[0], p[1] + h * n[1], p[2] + h * n[2])
