"""The exact engine: where the material ends along the normals of the nominal surface.

Source: closed form derived here: material ends where the least distance to all sweeps changes its
sign (docs/engine.md).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from stock.compile_ahead import await_compiled
from stock.compiled import read_only
from stock.errors import StockError
from stock.exact.meeting import Cut
from stock.exact.motion import build_motion, tip_positions
from stock.exact.outline import build_outlines
from stock.exact.tree import build_trees
from stock.exact.walk import CUT, GOUGED, UNCUT, Work, walk_lines, walk_part
from stock.sweeps import Sweeps
from stock.tools import Tool

__all__ = ["EdgeStatus", "Edges", "Material", "find_edges"]

#: a normal may be off unit length by this much: six decimals in a file
_UNIT = 1e-5


class EdgeStatus(IntEnum):
    """What the walk along a surface normal found."""

    CUT = CUT  #: a tool left the edge within reach
    UNCUT = UNCUT  #: material beyond the reach, or the blank's own surface
    GOUGED = GOUGED  #: air beyond the reach, inwards


@dataclass(frozen=True)
class Edges:
    """Edge of the material on P surface normals. Arrays are read-only.

    Attributes
    ----------
    deviation_mm : (P,) float64
        Signed distance from the nominal point to the edge along the outward normal, positive
        where material is left; 0 where `status` is not `EdgeStatus.CUT`.
    status : (P,) uint8
        An `EdgeStatus`.
    sweep : (P,) int64
        The sweep whose boundary is the edge, the last one where several are; -1 for none.
    parameter : (P,) float64
        Where on that sweep the tool made the edge, 0 at its start to 1 at its end.
    contact_mm : (P, 3) float64
        The edge measured from the displaced tool tip, in workpiece directions; 0 for none.
    """

    deviation_mm: np.ndarray
    status: np.ndarray
    sweep: np.ndarray
    parameter: np.ndarray
    contact_mm: np.ndarray

    def __len__(self) -> int:
        return len(self.status)


def find_edges(
    points_mm: np.ndarray,
    normals: np.ndarray,
    *,
    sweeps: Sweeps,
    tools: Sequence[Tool],
    blank_mm: tuple[Sequence[float] | np.ndarray, Sequence[float] | np.ndarray] | None,
    reach_mm: float = 1.0,
) -> Edges:
    """Find where the material that the sweeping tools leave ends along surface normals.

    Along the line p + h n the material is the blank minus the union of all sweeps. From a
    point in material the walk goes outwards to the first air; from a point in air it goes
    inwards along overlapping sweeps to where material begins. Sweeps without displacement
    give what the program itself leaves, cusps included.

    Parameters
    ----------
    points_mm, normals : (P, 3) array
        Points of the nominal surface and its outward unit normals, workpiece frame.
    sweeps : Sweeps
    tools : sequence of Tool
        What `sweeps.tool` counts in.
    blank_mm : pair of (3,) arrays, or None
        Least and largest corner of the blank; None for material without bounds.
    reach_mm : float
        How far from the nominal surface an edge is looked for.

    Returns
    -------
    Edges

    Raises
    ------
    StockError
        If an argument cannot be worked with.
    """
    return Material(sweeps, tools, blank_mm).edges(points_mm, normals, reach_mm)


class Material:
    """What sweeping tools leave of a blank, made ready for many questions.

    Parameters
    ----------
    sweeps : Sweeps or iterable of Sweeps
        In parts they need not all be there at once.
    tools, blank_mm
        As of `find_edges`.
    count : int, optional
        How many sweeps all parts have; needed with parts.
    """

    def __init__(
        self,
        sweeps: Sweeps | Iterable[Sweeps],
        tools: Sequence[Tool],
        blank_mm: tuple[Sequence[float] | np.ndarray, Sequence[float] | np.ndarray] | None,
        *,
        count: int | None = None,
    ) -> None:
        self._blank = _checked_blank(blank_mm)
        parts = [sweeps] if isinstance(sweeps, Sweeps) else sweeps
        count = len(sweeps) if isinstance(sweeps, Sweeps) else count
        size = np.array([math.hypot(tool.diameter_mm / 2, tool.length_mm) for tool in tools])
        motion = build_motion((_with_tools(part, tools) for part in parts), count, size)
        cut = Cut(motion, build_outlines(tools))
        self._work = Work(cut, build_trees(motion, size))

    def edges(self, points_mm: np.ndarray, normals: np.ndarray, reach_mm: float) -> Edges:
        """Edges on normals, (P, 3), through points, (P, 3) mm; as `find_edges`."""
        points, normals = _checked_points(points_mm, normals)
        if not (math.isfinite(reach_mm) and reach_mm > 0.0):
            raise StockError(f"reach_mm = {reach_mm!r}", accepted="a finite length above 0")
        await_compiled(walk_part)
        found = walk_lines(self._work, points, normals, self._blank, float(reach_mm))
        status, edge, parameter, sweep = found
        contact = np.zeros_like(points)
        known = np.flatnonzero(sweep >= 0)
        contact[known] = points[known] + edge[known, None] * normals[known]
        contact[known] -= tip_positions(self._work.cut.motion, sweep[known], parameter[known])
        arrays = (edge, status, sweep, parameter, contact)
        for array in arrays:
            array.setflags(write=False)
        return Edges(*arrays)


def _with_tools(sweeps: Sweeps, tools: Sequence[Tool]) -> Sweeps:
    sweeps.check_tools(len(tools))
    return sweeps


def _checked_points(points_mm: np.ndarray, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    points = np.ascontiguousarray(points_mm, dtype=np.float64)
    normals = np.ascontiguousarray(normals, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] != 3 or normals.shape != points.shape:
        raise StockError(
            f"points_mm has shape {points.shape} and normals has {normals.shape}",
            accepted="(P, 3) for both",
        )
    bad = np.flatnonzero(~(np.isfinite(points).all(axis=1) & np.isfinite(normals).all(axis=1)))
    if len(bad):
        raise StockError(
            f"point {bad[0]} at {points[bad[0]]} with normal {normals[bad[0]]} is not finite "
            f"({len(bad)} such points)",
            accepted="finite numbers",
        )
    length = np.linalg.norm(normals, axis=1)
    bad = np.flatnonzero(np.abs(length - 1.0) > _UNIT)
    if len(bad):
        raise StockError(
            f"normal of point {bad[0]} has length {length[bad[0]]:g} ({len(bad)} such points)",
            accepted=f"unit vectors within {_UNIT:g}",
        )
    return read_only(points), read_only(normals / length[:, None])


def _checked_blank(
    blank_mm: tuple[Sequence[float] | np.ndarray, Sequence[float] | np.ndarray] | None,
) -> np.ndarray:
    if blank_mm is None:
        return np.array([[-np.inf] * 3, [np.inf] * 3])
    blank = np.array(blank_mm, dtype=np.float64)
    if blank.shape != (2, 3) or not np.isfinite(blank).all() or not (blank[0] < blank[1]).all():
        raise StockError(
            f"blank_mm = {blank.tolist()}",
            accepted="two corners of three finite numbers, the first below the second",
        )
    return blank
