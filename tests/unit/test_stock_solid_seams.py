"""Pieces of a surface joined where they were split."""

from __future__ import annotations

import numpy as np
import pytest

from stock import StockError
from stock.solid.seams import PieceMesh, join_pieces
from tests.stock_solid_cases import edge_uses, mesh_volume

#: a unit cube's lower half: the seam is the square at z = 1, vertices 4 to 7
CORNERS = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
SIDES = [t for i in range(4) for j in [(i + 1) % 4] for t in ((i, j, 4 + j), (i, 4 + j, 4 + i))]
BOTTOM = [(0, 2, 1), (0, 3, 2)]


def lower() -> PieceMesh:
    vertices = np.vstack([np.column_stack([CORNERS, np.full(4, z)]) for z in (0.0, 1.0)])
    triangles = np.array(SIDES + BOTTOM)
    return PieceMesh(vertices, triangles, np.arange(len(triangles)))


def upper(*, extra: bool) -> PieceMesh:
    """The lower half turned over; with a vertex in the middle of one seam edge if asked."""
    piece = lower()
    vertices = piece.vertices_mm * [1, -1, -1] + [0, 1, 2]
    triangles = piece.triangles
    if extra:
        a, b = 4, 5
        row = next(k for k, t in enumerate(triangles) if {a, b} <= set(t.tolist()))
        apex = next(v for v in triangles[row].tolist() if v not in (a, b))
        vertices = np.vstack([vertices, (vertices[a] + vertices[b]) / 2])
        triangles = np.vstack([np.delete(triangles, row, axis=0), [[8, a, apex], [apex, b, 8]]])
    return PieceMesh(vertices, triangles, np.full(len(triangles), 100))


@pytest.mark.parametrize("extra", [False, True])
def test_two_halves_close(extra):
    joined = join_pieces([lower(), upper(extra=extra)])
    assert edge_uses(joined.triangles) == (0, 0)
    assert mesh_volume(joined.vertices_mm, joined.triangles) == pytest.approx(2.0, abs=1e-12)
    assert len(joined.vertices_mm) == 12 + extra
    assert len(joined.move) == len(joined.triangles) == 20 + 2 * extra
    assert (joined.move == 100).sum() == 10 + extra


def test_a_gap_is_an_error():
    apart = upper(extra=False)
    moved = PieceMesh(apart.vertices_mm * 1.1, apart.triangles, apart.move)
    with pytest.raises(StockError, match="does not close: 8 edges are open"):
        join_pieces([lower(), moved])
