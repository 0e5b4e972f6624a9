"""The virtual part: the solid that displaced tools leave of a blank, with its moves.

Source: the set operations are those of the library manifold3d.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from manifold3d import Manifold

from stock.errors import StockError
from stock.solid.advancing_cut import BLOCK_STROKES, finished_pieces
from stock.solid.blank import blank_solid
from stock.solid.buried_strokes import needed_strokes
from stock.solid.cutter_solids import CutterSolids
from stock.solid.joined_strokes import JoinedStrokes, join_strokes
from stock.solid.ring_stack import RingStack, ring_stack
from stock.solid.seams import PieceMesh, join_pieces
from stock.solid.strokes import Strokes, strokes_of
from stock.sweeps import Sweeps
from stock.tools import Tool

__all__ = ["BLANK", "VirtualPart", "cut_part"]

#: stands for the blank's own surface where a move is expected
BLANK = -1
#: a wall where the part was split for a while
_WALL = -2
#: more strokes than this are joined where they go on in nearly one line: within these shares of the
#: tolerance, one after the other until there are few enough
_FEW_STROKES, _JOINED = 20_000, (0.0, 0.2, 1.0)


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
    joined_mm : float
        How near to one line moves lie that were cut as one; 0 where none were.
    """

    vertices_mm: np.ndarray
    triangles: np.ndarray
    move: np.ndarray
    volume_mm3: float
    joined_mm: float = 0.0

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
    up to the tolerance. Planes keep every micrometre of the displacement. Of very many moves those
    that go on in nearly one line are cut as one. Numbers come from the exact engine; the solid is
    for looking at, volume and export.

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
    stacks = [ring_stack(tool, tolerance_mm) for tool in tools]
    cutters, joined, joined_mm = _cutters(
        strokes_of(sweeps, tolerance_mm), stacks, solid.bounding_box(), tolerance_mm
    )
    move_of_id = cutters.move_of_id
    move_of_id[solid.original_id()] = BLANK
    pieces, volume_mm3 = [], 0.0
    for piece in finished_pieces(solid, cutters, block_strokes=block_strokes, progress=progress):
        mesh = _mesh(piece, move_of_id)
        pieces.append(mesh if joined is None else _by_move(mesh, joined, stacks))
        volume_mm3 += piece.volume()
    whole = join_pieces(pieces)
    return VirtualPart(whole.vertices_mm, whole.triangles, whole.move, volume_mm3, joined_mm)


def _cutters(
    strokes: Strokes, stacks: Sequence[RingStack], box_mm: Sequence[float], tolerance_mm: float
) -> tuple[CutterSolids, JoinedStrokes | None, float]:
    """What has to be cut, by strokes as short as there is time for.

    Returns
    -------
    CutterSolids
        Without buried strokes.
    JoinedStrokes or None
        What they name, where they have been joined.
    float
        Distance within which they have been, mm.
    """
    low_mm, high_mm = np.reshape(box_mm, (2, 3))
    for share in _JOINED:
        limit_mm = share * tolerance_mm
        joined = join_strokes(strokes, limit_mm) if share else None
        found = joined.strokes if joined else strokes
        cutters = CutterSolids(found, stacks, top_mm=high_mm[2])
        needed = needed_strokes(cutters.footprints(), low_mm, high_mm)
        if needed.sum() <= _FEW_STROKES:
            break
    return CutterSolids(found.only(needed), stacks, top_mm=high_mm[2]), joined, limit_mm


def _by_move(mesh: PieceMesh, joined: JoinedStrokes, stacks: Sequence[RingStack]) -> PieceMesh:
    """A mesh whose triangles name joined strokes, by the moves of these."""
    move, cut = mesh.move.copy(), np.flatnonzero(mesh.move != BLANK)
    corners = mesh.vertices_mm[mesh.triangles[cut]]
    move[cut] = joined.moves_of(move[cut], corners, stacks)
    return replace(mesh, move=move)


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
