"""Which part of a surface a face covers: its edges as directed segments in u and v.

Every segment has the face on its left, seen from the tip of dS/du x dS/dv. That alone says what
is inside: going up along v through a segment that runs towards -u enters the face, one that
runs towards +u leaves it. No loop has to be closed or unwrapped, so cylinders with or without a
seam, poles and tori need no cases of their own. Seams are left out: they bound nothing.

Source: closed form derived here: the sense in which the nearest edge crosses a row of constant u
tells inside from outside.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vmach.nominal.surfaces import Surface
from vmach.nominal.surfaces.crossings import (
    INSIDE,
    MEETS_NO_EDGE,
    intervals_of_rows,
    line_crossings,
    polyline_segments,
    sides_of_points,
)

__all__ = ["Trim", "is_pole"]


@dataclass(frozen=True)
class Trim:
    """The edges of one face on its surface.

    Attributes
    ----------
    surface : Surface
    segments_mm : (S, 2, 3) float64
        Start and end of each segment.
    segments_uv : (S, 2, 2) float64
        The same in u and v; the end is on the same turn as the start.
    """

    surface: Surface
    segments_mm: np.ndarray
    segments_uv: np.ndarray

    @classmethod
    def from_polylines(cls, surface: Surface, polylines: list[np.ndarray]) -> Trim:
        """Trim from the edges' points in space, each (N, 3), the face on their left."""
        if not polylines:
            return cls(surface, np.empty((0, 2, 3)), np.empty((0, 2, 2)))
        after = np.cumsum([len(line) for line in polylines])
        points = np.concatenate(polylines)
        uv = surface.parameters(points)
        if np.isnan(uv[:, 0]).any():
            uv = np.concatenate([_defined(line) for line in np.split(uv, after[:-1])])
        periods = np.array([surface.u_period, surface.v_period])
        return cls(surface, *polyline_segments(points, np.ascontiguousarray(uv), after, periods))

    def gap_mm(self) -> float:
        """Largest distance of the segments' starts from the surface."""
        if not len(self.segments_uv):
            return 0.0
        off = self.surface.evaluate(self.segments_uv[:, 0]) - self.segments_mm[:, 0]
        return math.sqrt(np.einsum("ij,ij->i", off, off).max())

    def v_range(self) -> tuple[float, float]:
        """Lowest and highest v of the face; over a seam the highest lies beyond the period."""
        return self._v_range

    @cached_property
    def _v_range(self) -> tuple[float, float]:
        if self.surface.v_period:
            return self._v_range_around(self.surface.v_period)
        low, high = self.surface.v_limits
        v, begins = self._column
        if len(v) and begins[v.argmin()]:
            low = self.segments_uv[:, :, 1].min()
        if len(v) and not begins[v.argmax()]:
            high = self.segments_uv[:, :, 1].max()
        return low, high

    def grid(self, columns: int, rows: int) -> np.ndarray:
        """A grid of u and v over the face's extent, (columns, rows, 2)."""
        u = self.segments_uv[:, :, 0]
        turn = self.surface.u_period
        full = not u.size or (turn and np.ptp(u) > 0.5 * turn)
        ends = (0.0, turn) if full else (u.min(), u.max())
        grid = np.empty((columns, rows, 2))
        grid[:, :, 0] = np.linspace(*ends, columns)[:, None]
        grid[:, :, 1] = np.linspace(*self.v_range(), rows)
        return grid

    def row_intervals(self, levels: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Intervals of u that the face covers at levels of v, (R,); a full turn is one interval.

        Returns
        -------
        row : (I,) int64
            Index of the level of each interval, increasing.
        ends : (I, 2) float64
        """
        period = self.surface.u_period
        row, ends, meets = intervals_of_rows(
            self.segments_uv, np.ascontiguousarray(levels), period, self.surface.v_period
        )
        bare = np.flatnonzero(~meets) if period else np.empty(0, dtype=np.int64)
        whole = bare[self._covers_rows(levels[bare])]
        if len(whole):
            row = np.r_[row, whole]
            ends = np.vstack([ends, np.tile([0.0, period], (len(whole), 1))])
            order = np.argsort(row, kind="stable")
            row, ends = row[order], ends[order]
        return row, ends

    def contains(self, uv: np.ndarray) -> np.ndarray:
        """Mask of the points (N, 2) that lie inside the face."""
        if not len(self.segments_uv):
            return np.ones(len(uv), dtype=bool)
        surface, uv = self.surface, np.ascontiguousarray(uv)
        sides = sides_of_points(self.segments_uv, uv, surface.u_period, surface.v_period)
        inside = sides == INSIDE
        if surface.u_period:
            bare = np.flatnonzero(sides == MEETS_NO_EDGE)
            inside[bare] = self._covers_rows(uv[bare, 1])
        return inside

    def inside_out(self) -> bool:
        """Whether the edges say that the face is everything around them, without end.

        That can only be said where the surface neither closes nor ends in a pole.
        """
        surface = self.surface
        place, begins = self._row if surface.v_period else self._column
        if (surface.v_period and surface.u_period) or not len(place):
            return False
        known = np.array([not is_pole(surface, v) for v in surface.v_limits])
        wrong = np.array([not begins[np.argmin(place)], begins[np.argmax(place)]])
        return known.any() and bool(wrong[known].all())

    def transposed(self) -> Trim:
        """The same face with u and v exchanged, so that its rows are columns of this one."""
        segments_uv = np.ascontiguousarray(self.segments_uv[:, ::-1, ::-1])
        return Trim(_Transposed(self.surface), self.segments_mm[:, ::-1], segments_uv)

    def turned(self) -> Trim:
        """The same edges with the face on their other side."""
        segments_uv = np.ascontiguousarray(self.segments_uv[:, ::-1])
        return Trim(self.surface, self.segments_mm[:, ::-1], segments_uv)

    @cached_property
    def _column(self) -> tuple[np.ndarray, np.ndarray]:
        """Crossings of one column with the edges: v, and whether the face begins there."""
        return line_crossings(self.segments_uv, 0, self.surface.u_period)

    @cached_property
    def _row(self) -> tuple[np.ndarray, np.ndarray]:
        """Crossings of one row with the edges: u, and whether the face begins there."""
        u, upward = line_crossings(self.segments_uv, 1, self.surface.v_period)
        return u, ~upward

    def _covers_rows(self, v: np.ndarray) -> np.ndarray:
        """Whether rows (R,) that meet no edge are inside, from the nearest crossing of a column."""
        crossing, begins = self._column
        if not len(crossing) or not len(v):
            return np.ones(len(v), dtype=bool)
        period = self.surface.v_period
        height = crossing - v[:, None]
        height = np.mod(height, period) if period else height
        above = np.where(height > 0.0, height, np.inf)
        below = begins[np.argmax(height, axis=1)]
        return np.where(np.isfinite(above).any(axis=1), ~begins[np.argmin(above, axis=1)], below)

    def _v_range_around(self, period: float) -> tuple[float, float]:
        """Lowest and highest v where v closes: the turn without the widest part that is bare."""
        if not len(self.segments_uv):
            return 0.0, period
        ends = np.sort(self.segments_uv[:, :, 1], axis=1)
        begin = np.mod(ends[:, 0], period)
        order = np.argsort(begin)
        begin, reached = begin[order], np.maximum.accumulate((begin + np.ptp(ends, axis=1))[order])
        # the first gap runs from what reaches over the seam to the first edge behind it
        gap = np.r_[begin[0] + period - reached[-1], begin[1:] - reached[:-1]]
        bare = np.where(self._covers_rows(begin - gap / 2.0), 0.0, gap)
        widest = int(np.argmax(bare))
        if bare[widest] <= 0.0:
            return 0.0, period
        return float(begin[widest]), float(begin[widest] + period - gap[widest])


_EXCHANGED = str.maketrans("uv", "vu")


class _Transposed:
    """A surface with u and v exchanged, as far as rows of points ask for it."""

    def __init__(self, surface: Surface) -> None:
        self._surface = surface
        self.u_period, self.v_period = surface.v_period, surface.u_period
        self.v_limits = (-np.inf, np.inf)

    @property
    def varies(self) -> tuple[str, str]:
        along_u, along_v = self._surface.varies
        return along_v.translate(_EXCHANGED), along_u.translate(_EXCHANGED)

    def derivatives(self, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """dS/du and dS/dv of the exchanged u and v, (N, 3) each."""
        along_v, along_u = self._surface.derivatives(uv[:, ::-1])
        return along_u, along_v


def is_pole(surface: Surface, v: float) -> bool:
    """Whether all u meet in one point at v."""
    if not np.isfinite(v) or not surface.u_period:
        return False
    u = np.linspace(0.0, surface.u_period, 24, endpoint=False)
    around, _ = surface.derivatives(np.column_stack([u, np.full_like(u, v)]))
    return np.linalg.norm(around, axis=1).max() * surface.u_period < 1e-6


def _defined(uv: np.ndarray) -> np.ndarray:
    """At a pole, where u is not defined, an edge keeps the u that it arrives or leaves with."""
    lost = np.isnan(uv[:, 0])
    if lost.any() and not lost.all():
        known = np.flatnonzero(~lost)
        nearest = known[np.abs(np.arange(len(uv))[:, None] - known).argmin(axis=1)]
        uv = np.column_stack([uv[nearest, 0], uv[:, 1]])
    return uv
