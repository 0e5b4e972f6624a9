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
from vmach.nominal.surfaces.trimming import Trim

__all__ = ["SurfaceFace"]

#: a closed row of points, as around a bore, has at least this many
MIN_AROUND = 3

#: rows shorter than so many spacings have fewer than three points: their ends are added
MOST_ACROSS = 2.5

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
    """

    name: str
    kind: str
    trim: Trim
    outward: float
    area_mm2: float

    @property
    def surface(self) -> Surface:
        """The surface that the face is a part of."""
        return self.trim.surface

    @property
    def _width_mm(self) -> float:
        """Width of a long face of this area and perimeter; endless without edges."""
        perimeter = np.linalg.norm(np.diff(self.trim.segments_mm, axis=1)[:, 0], axis=1).sum()
        return 2.0 * self.area_mm2 / perimeter if perimeter else np.inf

    def normals(self, uv: np.ndarray) -> np.ndarray:
        """Outward unit normals, (N, 3)."""
        return self.outward * unit_normals(self.surface, uv)

    def sample(self, spacing_mm: float, edge_margin_mm: float) -> tuple[np.ndarray, np.ndarray]:
        """Points in rows `spacing_mm` apart and outward unit normals, (P, 3) mm each.

        Narrow faces get rows near their edges as well, so that at least three lie across them.
        """
        uv = sample_uv(self.trim, spacing_mm, spacing_mm)
        if self._width_mm < NARROW * spacing_mm:
            uv = np.vstack([uv, _rows_near_edges(self.trim, spacing_mm, edge_margin_mm)])
        points = self.surface.evaluate(uv)
        keep = ~near_segments(points, self.trim.segments_mm, edge_margin_mm)
        return points[keep], self.normals(uv[keep])


def _rows_near_edges(trim: Trim, spacing_mm: float, edge_margin_mm: float) -> np.ndarray:
    """Parameters of points near both ends of short rows, and in rows near the ends of v, (P, 2)."""
    surface, inset_mm = trim.surface, ROW_MARGINS * edge_margin_mm
    rows = []
    for v in _row_levels(trim, spacing_mm):
        for low, high in trim.row_intervals(v):
            if surface.u_period and high - low >= surface.u_period:
                continue
            u, length = _row_length(surface, v, (low, high))
            if 2.0 * inset_mm < length[-1] < MOST_ACROSS * spacing_mm:
                ends = np.interp([inset_mm, length[-1] - inset_mm], length, u)
                rows.append(np.column_stack([ends, np.full(2, v)]))
    v, length = _extent(trim)
    if 2.0 * inset_mm < length[-1] < MOST_ACROSS * spacing_mm:
        for level in np.interp([inset_mm, length[-1] - inset_mm], length, v):
            for low, high in trim.row_intervals(level):
                closed = bool(surface.u_period) and high - low >= surface.u_period
                u = _divide_row(surface, level, (low, high), spacing_mm, closed)
                rows.append(np.column_stack([u, np.full_like(u, level)]))
    return np.vstack(rows) if rows else np.empty((0, 2))


def sample_uv(trim: Trim, row_mm: float, point_mm: float) -> np.ndarray:
    """Parameters of points that fill the face, (P, 2).

    Rows of constant v, about `row_mm` apart, divide the face's extent evenly; points, about
    `point_mm` apart, divide each row's intervals inside the face evenly, so that narrow faces
    have their points in the middle.
    """
    rows, total = [], 0
    for number, v in enumerate(_row_levels(trim, row_mm)):
        for low, high in trim.row_intervals(v):
            closed = bool(trim.surface.u_period) and high - low >= trim.surface.u_period
            u = _divide_row(trim.surface, v, (low, high), point_mm, closed)
            if closed:
                u = u + (number * _GOLDEN % 1.0) * trim.surface.u_period / len(u)
            total += len(u)
            _check_count(total)
            rows.append(np.column_stack([u, np.full_like(u, v)]))
    return np.vstack(rows) if rows else np.empty((0, 2))


def _row_levels(trim: Trim, row_mm: float) -> np.ndarray:
    """Values of v of rows whose mean distance is the spacing."""
    return _divide(*_extent(trim), row_mm)


def _extent(trim: Trim) -> tuple[np.ndarray, np.ndarray]:
    """Values of v over the face, and the mean length up to each, mm."""
    grid = trim.grid(33)
    speed = np.linalg.norm(trim.surface.derivatives(grid.reshape(-1, 2))[1], axis=1)
    v = grid[0, :, 1]
    return v, _length_along(v, speed.reshape(33, 33).mean(axis=0))


def _row_length(
    surface: Surface, v: float, ends: tuple[float, float]
) -> tuple[np.ndarray, np.ndarray]:
    """Values of u over a row, and the length up to each, mm."""
    u = np.linspace(*ends, 33)
    speed = np.linalg.norm(surface.derivatives(np.column_stack([u, np.full_like(u, v)]))[0], axis=1)
    return u, _length_along(u, speed)


def _length_along(parameter: np.ndarray, speed: np.ndarray) -> np.ndarray:
    return np.r_[0.0, np.cumsum(np.diff(parameter) * (speed[:-1] + speed[1:]) / 2.0)]


def _divide_row(
    surface: Surface, v: float, ends: tuple[float, float], spacing_mm: float, closed: bool
) -> np.ndarray:
    u, length = _row_length(surface, v, ends)
    return _divide(u, length, spacing_mm, at_least=MIN_AROUND if closed else 1)


def _divide(
    parameter: np.ndarray, length: np.ndarray, spacing_mm: float, at_least: int = 1
) -> np.ndarray:
    """Parameters in the middle of equal lengths of about the spacing."""
    count = max(round(length[-1] / spacing_mm), at_least)
    _check_count(count)
    return np.interp((np.arange(count) + 0.5) * (length[-1] / count), length, parameter)


def _check_count(count: int) -> None:
    if count > MAX_POINTS:
        raise InputError(
            f"one face of the part asks for {count:.3g} points or more",
            accepted=f"at most {MAX_POINTS}",
            hint="is the unit of the file right? otherwise a larger [inspection] spacing_mm",
        )
