"""The virtual part: the solid that displaced tools leave of a blank, with its moves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from manifold3d import Manifold

from stock.blank import blank_solid
from stock.cutter_solids import CutterSolids
from stock.errors import StockError
from stock.ring_stack import ring_stack
from stock.strokes import strokes_of
from stock.sweeps import Sweeps
from stock.tools import Tool

__all__ = ["BLANK", "VirtualPart", "cut_part"]

#: stands for the blank's own surface where a move is expected
BLANK = -1


@dataclass(frozen=True)
class VirtualPart:
    """A closed surface of T triangles that know which move cut them.

    Attributes
    ----------
    vertices_mm : (V, 3) float64
        Workpiece coordinates.
    triangles : (T, 3) int64
        Vertices of each triangle, counter-clockwise seen from outside.
    move : (T,) int64
        The move that left the triangle; `BLANK` on the blank's own surface.
    volume_mm3 : float
    """

    vertices_mm: np.ndarray
    triangles: np.ndarray
    move: np.ndarray
    volume_mm3: float


def cut_part(
    sweeps: Sweeps,
    tools: Sequence[Tool],
    blank: Any,
    *,
    tolerance_mm: float = 0.01,
    progress: Callable[[int, int], None] | None = None,
) -> VirtualPart:
    """Remove from the blank everything that the displaced tools sweep.

    Round tools and arcs are faceted with corners on the true surface, so material may be left
    by up to the tolerance; planes keep every micrometre of the displacement. Numbers come from
    the exact engine, the solid is for looking at, volume, export and collision.

    Parameters
    ----------
    sweeps : Sweeps
    tools : sequence of Tool
        What ``sweeps.tool`` points into.
    blank : pair of (3,) float64, or a mesh
        See `stock.blank.blank_solid`.
    tolerance_mm : float
        Largest sagitta of a facet's chord on a tool or along an arc.
    progress : callable, optional
        Called with the number of strokes done and their total.

    Raises
    ------
    StockError
        If the blank is no solid or the tolerance is not positive.
    """
    if not tolerance_mm > 0:
        raise StockError(f"tolerance of {tolerance_mm!r} mm", accepted="a positive length")
    solid = blank_solid(blank)
    bounds = np.reshape(solid.bounding_box(), (2, 3))
    strokes = strokes_of(sweeps, tolerance_mm)
    stacks = [ring_stack(tool, tolerance_mm) for tool in tools]
    cutters = CutterSolids(strokes, stacks, bounds[1, 2])
    low, high = cutters.boxes()
    index = np.flatnonzero(((low < bounds[1]) & (high > bounds[0])).all(axis=1))
    finished = 0

    def done(count: int) -> None:
        nonlocal finished
        finished += count
        if progress:
            progress(finished, len(index))

    if len(index):
        solid = solid - cutters.union(index, done)
    return _part(solid, cutters.move_of_id)


def _part(solid: Manifold, move_of_id: dict[int, int]) -> VirtualPart:
    mesh = solid.to_mesh64()
    run_move = np.array([move_of_id.get(int(i), BLANK) for i in mesh.run_original_id], np.int64)
    lengths = np.diff(np.asarray(mesh.run_index, dtype=np.int64)) // 3
    return VirtualPart(
        vertices_mm=np.asarray(mesh.vert_properties)[:, :3].copy(),
        triangles=np.asarray(mesh.tri_verts).astype(np.int64),
        move=np.repeat(run_move, lengths),
        volume_mm3=solid.volume(),
    )
