"""Is a triangle soup the closed, consistently wound, non-intersecting surface of a solid?

Source: closed form derived here: a surface is closed where each edge is run along equally often
both ways.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vmach.errors import InputError
from vmach.nominal.mesh.triangle_pairs import count_hits
from vmach.nominal.mesh.unique_rows import unique_rows

__all__ = ["check_closed", "count_intersections", "edge_sides", "merge_corners"]

#: triangle pairs that the intersection check looks at before it gives up
MAX_PAIRS = 20_000_000

#: surfaces this many steps of a 32-bit coordinate apart, or less, lie on each other
_ROUNDINGS = 8.0

_HINT = "export the solid again, or repair it in the CAD system"


def merge_corners(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Vertices (V, 3), triangles (T, 3) and the tolerance (mm) within which corners were merged.

    Equal corners become one vertex. If that leaves open edges, corners within the resolution of
    the file's 32-bit numbers are merged too. Triangles that lose a corner are dropped.
    """
    for tolerance in (0.0, 4.0 * float(np.spacing(np.float32(np.abs(corners).max())))):
        vertices, triangles = _merge_within(corners.reshape(-1, 3), tolerance)
        distinct = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
        if not _unpaired(distinct).any():
            break
    return vertices, distinct, tolerance


def _merge_within(points: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    keys = np.round(points / tolerance) if tolerance else points + 0.0  # + 0.0: -0.0 is 0.0
    first, inverse, _ = unique_rows(keys)
    return points[first], inverse.reshape(-1, 3)


def edge_sides(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Directed edges of all triangles, sorted so that the sides of one edge are neighbours.

    Returns
    -------
    edge : (3T, 2) int64
        Lower and higher vertex of the edge.
    forward : (3T,) bool
        Whether the triangle runs along it from the lower to the higher vertex.
    triangle : (3T,) int64
        The triangle that the side belongs to.
    """
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    low, high = np.minimum(start, end), np.maximum(start, end)
    order = np.lexsort((start != low, high, low))
    edge = np.column_stack([low, high])[order]
    return edge, (start == low)[order], order // 3


def _unpaired(triangles: np.ndarray) -> np.ndarray:
    """Sum of the directions in which each edge is run along, for all edges; 0 when closed."""
    edge, forward, _ = edge_sides(triangles)
    if not len(edge):
        return np.zeros(0, dtype=np.int64)
    first = _first_of_runs(edge)
    return np.add.reduceat(np.where(forward, 1, -1), first)


def _first_of_runs(edge: np.ndarray) -> np.ndarray:
    return np.flatnonzero(np.r_[True, (edge[1:] != edge[:-1]).any(axis=1)])


def check_closed(path: Path, vertices: np.ndarray, triangles: np.ndarray) -> None:
    """Raise InputError unless every edge of (T, 3) triangles is run along equally both ways."""
    balance = _unpaired(triangles)
    if not balance.any():
        return
    edge, _, _ = edge_sides(triangles)
    first = _first_of_runs(edge)
    sides = np.diff(np.r_[first, len(edge)])
    twisted = int(((balance != 0) & (sides % 2 == 0)).sum())
    open_edges = int((balance != 0).sum()) - twisted
    middle = vertices[edge[first[np.argmax(balance != 0)]]].mean(axis=0)
    where = f"the first near ({middle[0]:.3f}, {middle[1]:.3f}, {middle[2]:.3f})"
    if open_edges:
        what = f"the mesh is open: {open_edges} of {len(first)} edges have a side missing, {where}"
    else:
        what = f"triangles disagree on what is outside at {twisted} edges, {where}"
    raise InputError(what, file=path, accepted="a closed surface of a solid", hint=_HINT)


def count_intersections(vertices: np.ndarray, triangles: np.ndarray) -> int | None:
    """How many pairs of (T, 3) triangles cut through or lie on each other; None: too many.

    Found are edges that pierce the inside of another triangle, which every transversal
    intersection of closed surfaces has, and triangles that overlap within one plane.
    """
    corners = vertices[triangles]
    pairs = _overlapping_boxes(corners)
    if pairs is None:
        return None
    rounding = _ROUNDINGS * float(np.spacing(np.float32(np.abs(vertices).max())))
    return int(count_hits(corners, triangles, pairs, rounding))


def _overlapping_boxes(corners: np.ndarray) -> np.ndarray | None:
    """Pairs of triangles whose bounding boxes overlap, found down a tree of boxes."""
    order, levels = _box_tree(corners.min(axis=1), corners.max(axis=1))
    pairs = np.zeros((1, 2), dtype=np.int64)
    for low, high in levels[1:]:
        same = pairs[:, 0] == pairs[:, 1]
        a, b = 2 * pairs[:, 0], 2 * pairs[:, 1]
        pairs = np.vstack(
            [
                np.column_stack([a, b]),
                np.column_stack([a, b + 1]),
                np.column_stack([a + 1, b + 1]),
                np.column_stack([a + 1, b])[~same],
            ]
        )
        a, b = pairs.T
        pairs = pairs[((low[a] <= high[b]) & (low[b] <= high[a])).all(axis=1)]
        if len(pairs) > MAX_PAIRS:
            return None
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    return order[pairs]


def _box_tree(
    low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, list[tuple[np.ndarray, np.ndarray]]]:
    """Binary tree over boxes in Morton order: names of the leaves, boxes of each level."""
    order = np.argsort(_morton_code((low + high) / 2.0), kind="stable")
    depth = int(len(low) - 1).bit_length()
    padding = ((0, 2**depth - len(low)), (0, 0))
    lower = np.pad(low[order], padding, constant_values=np.inf)  # overlaps nothing
    upper = np.pad(high[order], padding, constant_values=-np.inf)
    levels = [(lower, upper)]
    for _ in range(depth):
        lower = np.minimum(lower[::2], lower[1::2])
        upper = np.maximum(upper[::2], upper[1::2])
        levels.insert(0, (lower, upper))
    return order, levels


def _morton_code(points: np.ndarray) -> np.ndarray:
    """Bits of the coordinates interleaved: near numbers are near points."""
    cells = (points - points.min(axis=0)) * (1023.0 / max(np.ptp(points, axis=0).max(), 1e-300))
    cells = cells.astype(np.int64)
    code = np.zeros(len(points), dtype=np.int64)
    for bit in range(10):
        for axis in range(3):
            code |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return code
