"""The virtual part: the solid that displaced tools leave of a blank, with its moves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from manifold3d import Manifold

from stock.advancing_cut import finished_pieces
from stock.blank import blank_solid
from stock.cutter_solids import CutterSolids
from stock.errors import StockError
from stock.ring_stack import ring_stack
from stock.seams import PieceMesh, join_pieces
from stock.strokes import strokes_of
from stock.sweeps import Sweeps
from stock.tools import Tool

__all__ = ["BLANK", "VirtualPart", "cut_part"]

#: stands for the blank's own surface where a move is expected
BLANK = -1
#: a wall where the part was split for a while
_WALL = -2


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
        Called every few strokes with how many of how many straight strokes are cut.

    Raises
    ------
    StockError
        If the blank is no solid or the tolerance is not positive.
    """
    if not tolerance_mm > 0:
        raise StockError(f"tolerance of {tolerance_mm!r} mm", accepted="a positive length")
    solid = blank_solid(blank)
    strokes = strokes_of(sweeps, tolerance_mm)
    stacks = [ring_stack(tool, tolerance_mm) for tool in tools]
    cutters = CutterSolids(strokes, stacks, top_mm=solid.bounding_box()[5])
    move_of_id = cutters.move_of_id
    move_of_id[solid.original_id()] = BLANK
    pieces, volume_mm3 = [], 0.0
    for piece in finished_pieces(solid, cutters, progress=progress):
        pieces.append(_mesh(piece, move_of_id))
        volume_mm3 += piece.volume()
    joined = join_pieces(pieces)
    return VirtualPart(joined.vertices_mm, joined.triangles, joined.move, volume_mm3)


def _mesh(solid: Manifold, move_of_id: dict[int, int]) -> PieceMesh:
    """Triangles whose origin is known: all but the walls where pieces were split."""
    mesh = solid.to_mesh64()
    origin = [move_of_id.get(int(number), _WALL) for number in mesh.run_original_id]
    lengths = np.diff(np.asarray(mesh.run_index, dtype=np.int64)) // 3
    move = np.repeat(np.array(origin, dtype=np.int64), lengths)
    triangles = np.asarray(mesh.tri_verts).astype(np.int64)
    kept = move != _WALL
    return PieceMesh(np.asarray(mesh.vert_properties)[:, :3], triangles[kept], move[kept])
