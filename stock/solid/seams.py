"""Pieces of one surface put together again where they were split.

Both sides of a split get the same vertices bit for bit, but a side that is worked on further may
lose vertices in the middle of straight edges. So equal vertices are made one, and the longer
edges are divided where the other side has vertices on them.

Source: closed form derived here: an edge is divided where another vertex lies on it.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stock.errors import StockError

__all__ = ["PieceMesh", "join_pieces", "open_edges"]

#: a vertex closer to an edge than this lies on it
_ON_EDGE_MM = 1e-8


@dataclass(frozen=True)
class PieceMesh:
    """Triangles of a piece of the part, without the walls along which it was split off.

    Attributes
    ----------
    vertices_mm : (V, 3) float64
    triangles : (T, 3) int64
    move : (T,) int64
    """

    vertices_mm: np.ndarray
    triangles: np.ndarray
    move: np.ndarray


def open_edges(triangles: np.ndarray) -> np.ndarray:
    """Directed edges (E, 2) that no triangle runs through the other way."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    count = np.int64(triangles.max(initial=0)) + 1
    return edges[~np.isin(edges[:, 0] * count + edges[:, 1], edges[:, 1] * count + edges[:, 0])]


def join_pieces(pieces: list[PieceMesh]) -> PieceMesh:
    """One closed mesh of all pieces.

    Raises
    ------
    StockError
        If the pieces do not close up.
    """
    first = np.cumsum([0] + [len(piece.vertices_mm) for piece in pieces])[:-1].tolist()
    vertices = np.concatenate([piece.vertices_mm for piece in pieces])
    triangles = np.concatenate([p.triangles + k for p, k in zip(pieces, first, strict=True)])
    move = np.concatenate([piece.move for piece in pieces])
    edges = [open_edges(p.triangles) + k for p, k in zip(pieces, first, strict=True)]
    border = np.unique(np.concatenate(edges))
    if len(border):
        weld = _welded(vertices, border)
        triangles = weld[triangles]
        triangles, move = _close(vertices, triangles, move, weld[np.concatenate(edges)])
    used = np.zeros(len(vertices), dtype=bool)
    used[triangles] = True
    return PieceMesh(vertices[used], (np.cumsum(used) - 1)[triangles], move)


def _welded(vertices: np.ndarray, border: np.ndarray) -> np.ndarray:
    """For every vertex the one that stands for it: equal places on the border become one."""
    _, first, group = np.unique(vertices[border], axis=0, return_index=True, return_inverse=True)
    stands_for = np.arange(len(vertices))
    stands_for[border] = border[first[group.reshape(-1)]]
    return stands_for


def _unpaired(edges: np.ndarray) -> np.ndarray:
    """Those of the directed edges (E, 2) that do not come the other way as well."""
    present = set(map(tuple, edges.tolist()))
    return np.array([e for e in present if e[::-1] not in present], np.int64).reshape(-1, 2)


def _close(
    vertices: np.ndarray, triangles: np.ndarray, move: np.ndarray, edges: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Divide unpaired edges (and their triangles) at the vertices that lie on them."""
    while len(loose := _unpaired(edges)):
        places = np.unique(loose)
        divided = {tuple(e): _on_edge(vertices, e, places) for e in loose.tolist()}
        divided = {e: inside for e, inside in divided.items() if len(inside)}
        if not divided:
            raise StockError(
                f"the virtual part does not close: {len(loose)} edges are open near"
                f" {np.round(vertices[places[0]], 3).tolist()} mm",
                hint="another tolerance may help",
            )
        triangles, move, done = _divide(triangles, move, divided)
        kept = [e for e in map(tuple, edges.tolist()) if e not in done]
        edges = np.array(kept + [pair for e in done for pair in _chain(e, divided[e])])
    return triangles, move


def _on_edge(vertices: np.ndarray, edge: list[int], places: np.ndarray) -> np.ndarray:
    """Those of the vertices `places` that lie within an edge, from its start to its end."""
    start, end = vertices[edge[0]], vertices[edge[1]]
    along = end - start
    arm = vertices[places] - start
    share = arm @ along / (along @ along)
    off = np.linalg.norm(arm - share[:, None] * along, axis=1)
    inner = (off < _ON_EDGE_MM) & (share > 0) & (share < 1) & ~np.isin(places, edge)
    return places[inner][np.argsort(share[inner])]


def _chain(edge: tuple[int, int], inside: np.ndarray) -> list[tuple[int, int]]:
    stops = [edge[0], *inside.tolist(), edge[1]]
    return list(pairwise(stops))


def _divide(
    triangles: np.ndarray, move: np.ndarray, divided: dict[tuple[int, int], np.ndarray]
) -> tuple[np.ndarray, np.ndarray, set[tuple[int, int]]]:
    """Replace triangles by fans, one edge of a triangle at a time."""
    touched = np.zeros(triangles.max() + 1, dtype=bool)
    touched[[v for edge in divided for v in edge]] = True
    replaced, fans, fan_moves, done = [], [], [], set()
    for row in np.flatnonzero(touched[triangles].sum(axis=1) >= 2):
        a, b, c = triangles[row].tolist()
        for edge, apex in (((a, b), c), ((b, c), a), ((c, a), b)):
            if edge in divided:
                fans += [(p, q, apex) for p, q in _chain(edge, divided[edge])]
                fan_moves += [move[row]] * (len(divided[edge]) + 1)
                replaced.append(row)
                done.add(edge)
                break
    triangles = np.vstack([np.delete(triangles, replaced, axis=0), fans])
    return triangles, np.concatenate([np.delete(move, replaced), fan_moves]), done
