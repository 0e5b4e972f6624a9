"""A face of exact geometry: points and normals on it, and triangles to look at.

Source: ISO 10303-42 (sense of a face against its surface).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.errors import InputError
from vmach.nominal.mesh.thinning import near_segments
from vmach.nominal.part import MAX_POINTS, NARROW, ROW_MARGINS
from vmach.nominal.surfaces import Surface, unit_normals
from vmach.nominal.surfaces.crossings import interpolated
from vmach.nominal.surfaces.trimming import Trim
from vmach.nominal.weights import shared_weights

__all__ = ["SurfaceFace"]

#: a closed row of points, as around a bore, has at least this many
MIN_AROUND = 3

#: pieces of a row that its length is summed over
_PIECES = 32

#: the golden ratio's share of a turn, by which closed rows are turned against each other
_GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0


@dataclass(frozen=True)
class SurfaceFace:
    """A trimmed surface of a solid.

    Attributes
    ----------
    name, kind : str
        ``face 12 cylinder R20``; ``cylinder``.
    trim : Trim
        The surface and the edges on it.
    outward : float
        +1 where dS/du x dS/dv points out of the material, -1 where it points in.
    area_mm2 : float
        Area, from the display mesh.
    number : int
        Of the face in its file; 0 where there is none.
    title : str
        That the CAD gives the face; may be empty.
    """

    name: str
    kind: str
    trim: Trim
    outward: float
    area_mm2: float
    number: int = 0
    title: str = ""

    @property
    def surface(self) -> Surface:
        """The surface that the face is a part of."""
        return self.trim.surface

    def normals(self, uv: np.ndarray) -> np.ndarray:
        """Outward unit normals, (N, 3)."""
        return self.outward * unit_normals(self.surface, uv)

    def sample(
        self, spacing_mm: float, edge_margin_mm: float
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Points in rows `spacing_mm` apart, outward unit normals, (P, 3) mm each, and weights.

        Where the face is narrow it gets points near its edges as well, so that at least three lie
        across it.
        """
        rows = _Rows.of(self.trim, spacing_mm)
        columns = _Rows.of(self.trim.transposed(), spacing_mm)
        inset_mm = ROW_MARGINS * edge_margin_mm
        even = rows.evenly(spacing_mm)
        beside = rows.near_edges(spacing_mm, inset_mm), columns.near_edges(spacing_mm, inset_mm)
        uv = np.concatenate([even, beside[0], beside[1][:, ::-1]])
        points = self.surface.evaluate(uv)
        keep = ~near_segments(points, self.trim.segments_mm, edge_margin_mm)
        first = np.count_nonzero(keep[: len(even)])
        points = points[keep]
        return points, self.normals(uv[keep]), shared_weights(points[:first], points[first:])


def sample_uv(trim: Trim, row_mm: float, point_mm: float) -> np.ndarray:
    """Parameters of points that fill the face, (P, 2).

    Rows of constant v, about `row_mm` apart, divide the face's extent evenly; points, about
    `point_mm` apart, divide each row's intervals inside the face evenly, so that narrow faces
    have their points in the middle.
    """
    return _Rows.of(trim, row_mm).evenly(point_mm)


@dataclass(frozen=True)
class _Rows:
    """Intervals of u that a face covers at some levels of v.

    Attributes
    ----------
    row : (I,) int64
        Index of the level of each interval.
    v : (I,) float64
    u : (I, N) float64
        Values over each interval, evenly apart.
    length_mm : (I, N) float64
        Length from its beginning up to each.
    is_closed : (I,) bool
        Whether it goes round to its beginning.
    period : float
        Of u; 0 where it does not close.
    """

    row: np.ndarray
    v: np.ndarray
    u: np.ndarray
    length_mm: np.ndarray
    is_closed: np.ndarray
    period: float

    @classmethod
    def of(cls, trim: Trim, row_mm: float) -> _Rows:
        """Intervals in rows about `row_mm` apart, which divide the face's extent evenly."""
        levels = _divide(*_extent(trim), row_mm)
        row, ends = trim.row_intervals(levels)
        v, period = levels[row], trim.surface.u_period
        places = _PIECES + 1 if "u" in trim.surface.varies[0] else 2
        u = np.ascontiguousarray(np.linspace(ends[:, 0], ends[:, 1], places, axis=1))
        along, _ = trim.surface.derivatives(np.column_stack([u.ravel(), np.repeat(v, places)]))
        speed = np.linalg.norm(along, axis=1).reshape(u.shape)
        closed = np.ptp(ends, axis=1) >= period if period else np.zeros(len(row), dtype=bool)
        return cls(row, v, u, _length_along(u, speed), closed, period)

    def evenly(self, spacing_mm: float) -> np.ndarray:
        """u and v of points that divide each interval evenly, about the spacing apart, (P, 2)."""
        interval, uv = self.divided(spacing_mm)
        # closed rows are turned against each other
        turn = np.where(self.is_closed, self.row * _GOLDEN % 1.0, 0.0) * self.period
        uv[:, 0] += (turn / np.bincount(interval, minlength=len(turn)))[interval]
        return uv

    def near_edges(self, spacing_mm: float, inset_mm: float) -> np.ndarray:
        """u and v of points this far from both ends of intervals that are short, (P, 2)."""
        across = self.length_mm[:, -1]
        short = ~self.is_closed & (2.0 * inset_mm < across) & (across < NARROW * spacing_mm)
        interval = np.repeat(np.flatnonzero(short), 2)
        inset = np.where(np.arange(len(interval)) % 2, across[interval] - inset_mm, inset_mm)
        return self._at(inset, interval)

    def divided(self, spacing_mm: float) -> tuple[np.ndarray, np.ndarray]:
        """Points in the middle of equal lengths of about the spacing.

        Returns the interval of each, (P,), and u and v, (P, 2).
        """
        whole = self.length_mm[:, -1]
        wanted = np.maximum(np.rint(whole / spacing_mm), np.where(self.is_closed, MIN_AROUND, 1))
        _check_count(wanted.sum())
        count = wanted.astype(np.int64)
        interval = np.repeat(np.arange(len(count)), count)
        number = np.arange(len(interval)) - np.repeat(np.cumsum(count) - count, count)
        return interval, self._at((number + 0.5) * (whole / count)[interval], interval)

    def _at(self, length_mm: np.ndarray, interval: np.ndarray) -> np.ndarray:
        """u and v at lengths from the beginning of intervals, (P, 2)."""
        u = interpolated(length_mm, interval, self.length_mm, self.u)
        return np.column_stack([u, self.v[interval]])


def _extent(trim: Trim) -> tuple[np.ndarray, np.ndarray]:
    """Values of v over the face, and the mean length up to each, mm."""
    varies = trim.surface.varies[1]
    grid = trim.grid(_PIECES + 1 if "u" in varies else 1, _PIECES + 1 if "v" in varies else 2)
    speed = np.linalg.norm(trim.surface.derivatives(grid.reshape(-1, 2))[1], axis=1)
    v = grid[0, :, 1]
    return v, _length_along(v, speed.reshape(grid.shape[:2]).mean(axis=0))


def _length_along(parameter: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Length up to each parameter along the last axis, by the trapezoidal rule, mm."""
    pieces = np.diff(parameter) * (speed[..., :-1] + speed[..., 1:]) / 2.0
    return np.concatenate([np.zeros_like(pieces[..., :1]), np.cumsum(pieces, axis=-1)], axis=-1)


def _divide(parameter: np.ndarray, length: np.ndarray, spacing_mm: float) -> np.ndarray:
    """Parameters in the middle of equal lengths of about the spacing."""
    count = max(round(length[-1] / spacing_mm), 1)
    _check_count(count)
    return np.interp((np.arange(count) + 0.5) * (length[-1] / count), length, parameter)


def _check_count(count: float) -> None:
    if count > MAX_POINTS:
        raise InputError(
            f"one face of the part asks for {count:.3g} points or more",
            accepted=f"at most {MAX_POINTS}",
            hint="is the unit of the file right? otherwise a larger [inspection] spacing_mm",
        )
