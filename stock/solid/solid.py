"""The virtual part: the solid that displaced tools leave of a blank, with its moves."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from manifold3d import Manifold

from stock.errors import StockError
from stock.solid.advancing_cut import BLOCK_STROKES, finished_pieces
from stock.solid.blank import blank_solid
from stock.solid.buried_strokes import needed_strokes
from stock.solid.cutter_solids import CutterSolids
from stock.solid.ring_stack import ring_stack
from stock.solid.seams import PieceMesh, join_pieces
from stock.solid.strokes import strokes_of
from stock.sweeps import Sweeps
from stock.tools import Tool

__all__ = ["BLANK", "VirtualPart", "cut_part"]

#: stands for the blank's own surface where a move is expected
BLANK = -1
#: a wall where the part was split for a while
_WALL = -2


@dataclass(frozen=True)
class VirtualPart:
    """A closed surface of T triangles that know which move cut them. Arrays are read-only.

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

    def __post_init__(self) -> None:
        for array in (self.vertices_mm, self.triangles, self.move):
            array.setflags(write=False)


def cut_part(
    sweeps: Sweeps,
    tools: Sequence[Tool],
    blank: Any,
    *,
    tolerance_mm: float = 0.01,
    block_strokes: int = BLOCK_STROKES,
    progress: Callable[[int, int], None] | None = None,
) -> VirtualPart:
    """Remove from the blank everything that the displaced tools sweep.

    Round tools are faceted with corners on the true surface: they leave up to the tolerance of
    material, twice that where they are curved both ways, and cut too deep only inside arcs, by
    up to the tolerance. Planes keep every micrometre of the displacement. Numbers come from the
    exact engine; the solid is for looking at, volume and export.

    Parameters
    ----------
    sweeps : Sweeps
    tools : sequence of Tool
        What ``sweeps.tool`` points into.
    blank : pair of (3,) float64, or a mesh
        See `stock.solid.blank.blank_solid`.
    tolerance_mm : float
        Largest sagitta of a chord around the tool's axis, along its outline, and along an arc.
    block_strokes : int
        Strokes that are cut before finished material is set aside; bounds the working memory.
    progress : callable, optional
        Called every few strokes with how many of how many straight strokes are cut.

    Raises
    ------
    StockError
        If the blank is no solid, a sweep has no tool, or the tolerance or the block is not
        positive.
    """
    sweeps.check_tools(len(tools))
    if not 0 < tolerance_mm < np.inf:
        raise StockError(f"tolerance of {tolerance_mm!r} mm", accepted="a positive length")
    if block_strokes < 1:
        raise StockError(f"blocks of {block_strokes!r} strokes", accepted="1 or more")
    solid = blank_solid(blank)
    strokes = strokes_of(sweeps, tolerance_mm)
    stacks = [ring_stack(tool, tolerance_mm) for tool in tools]
    low_mm, high_mm = np.reshape(solid.bounding_box(), (2, 3))
    cutters = CutterSolids(strokes, stacks, top_mm=high_mm[2])
    needed = needed_strokes(cutters.footprints(), low_mm, high_mm)
    cutters = CutterSolids(strokes.only(needed), stacks, top_mm=high_mm[2])
    move_of_id = cutters.move_of_id
    move_of_id[solid.original_id()] = BLANK
    pieces, volume_mm3 = [], 0.0
    for piece in finished_pieces(solid, cutters, block_strokes=block_strokes, progress=progress):
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
    vertices = np.array(mesh.vert_properties)  # a view would keep the whole mesh alive
    return PieceMesh(vertices, triangles[kept], move[kept])
