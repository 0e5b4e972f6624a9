"""Bounding-volume trees over sweeps, one a tool, for finding the sweeps near a point.

A node holds the box of the displaced tool tip, not of the swept tool. The outline itself bounds
from below the distance of a point from a tool whose tip is anywhere in the box. So a query
reaches only the sweeps that are really near, however large the tool is.

Thousands of sweeps of a large tool may pass over one place of a floor. The boxes are too coarse to
tell which of them went deepest there, and tilt makes them coarser. So a node also knows in full
precision how low its tips come, and how they are tilted: `_below_tips`.

Source: closed form derived here: a distance to a box bounds the distance to all that is in it
from below.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from stock.compiled import njit_inlined, njit_kernel, read_only
from stock.exact.motion import Motion, bend_of, bend_of_height, on_arcs, tip_at, tools_of
from stock.exact.outline import lower_bound
from stock.threads import run_in_parts

__all__ = [
    "Trees",
    "bound_of_node",
    "bound_of_piece",
    "build_trees",
    "morton_order",
    "pieces_of_leaf",
]

#: pieces in a leaf
LEAF = 4
#: an arc is cut into pieces of at most this angle, rad: along one, the distance to a point
#: has one minimum or falls towards the ends
_PIECE_RAD = math.pi / 4
#: rows whose intermediate values are held at a time
_ROWS_AT_ONCE = 65_536
#: relative rounding of single precision
_SINGLE = 1.2e-7
#: where the boxes of empty nodes are: far, yet finite
_NOWHERE_MM = 1e12


class Trees(NamedTuple):
    """Complete binary trees, in heap order, over pieces of sweeps sorted along a Morton curve.

    Attributes
    ----------
    sweep : (K,) int32
        Sweep of each piece; the pieces of one tool lie together.
    span : (K, 2) float64
        The part of the sweep, as two values of s.
    first_piece, first_node, leaves : (T,) int64
        Where the pieces and the nodes of a tool begin, and its number of leaves, a power of 2.
    piece_count : (T,) int64
    box : (N, 6) float32
        Least and largest x, y, z of the displaced tip; node 1 of a tool is its root.
    last : (N,) int32
        Largest sweep number in the node.
    slack_mm : (T,) float64
        How far the tilt can move a point of the tool.
    low_mm : (N,) float64
        Least z of the displaced tip.
    tilt : (N, 4) or (0, 4) float32
        Least tilt about x and y, largest tilt about x and y, rad.
    largest_tilt : float
        Of all sweeps, rad.
    """

    sweep: np.ndarray
    span: np.ndarray
    first_piece: np.ndarray
    piece_count: np.ndarray
    first_node: np.ndarray
    leaves: np.ndarray
    box: np.ndarray
    last: np.ndarray
    piece_box: np.ndarray
    slack_mm: np.ndarray
    low_mm: np.ndarray
    tilt: np.ndarray
    largest_tilt: float


def build_trees(motion: Motion, reach_of_tool_mm: np.ndarray) -> Trees:
    """Sort the pieces of all sweeps and bound them, tool by tool; reaches (T,) mm."""
    sweep, span = _pieces(motion, on_arcs(motion))
    tool = tools_of(motion)[sweep]
    box = _piece_boxes(motion, sweep, span)
    first_piece, piece_count, first_node, leaves = [], [], [], []
    order, done, nodes = [np.zeros(0, dtype=np.int64)], 0, 0
    for t in range(len(reach_of_tool_mm)):
        mine = np.flatnonzero(tool == t)
        mine = mine[_order_of_boxes(box, mine)]
        order.append(mine)
        count = 1 << max(0, math.ceil(math.log2(max(1, math.ceil(len(mine) / LEAF)))))
        first_piece.append(done)
        piece_count.append(len(mine))
        first_node.append(nodes)
        leaves.append(count)
        done += len(mine)
        nodes += 2 * count
    order = np.concatenate(order)
    sweep = sweep[order]  # one after the other: each needs its room twice
    span = span[order]
    box = box[order]
    del order
    node_box = np.empty((nodes, 6), dtype=np.float32)
    node_box[:, :3], node_box[:, 3:] = _NOWHERE_MM, -_NOWHERE_MM
    last = np.full(nodes, -1, dtype=np.int32)
    low = np.full(nodes, _NOWHERE_MM)
    tilt = np.empty((nodes if len(motion.tilt) else 0, 4), dtype=np.float32)
    tilt[:, :2], tilt[:, 2:] = np.inf, -np.inf
    for t in range(len(leaves)):
        mine = slice(first_piece[t], first_piece[t] + piece_count[t])
        own = slice(first_node[t], first_node[t] + 2 * leaves[t])
        _fill_nodes((box[mine], sweep[mine]), node_box[own], last[own])
        _fill_floors(motion, (sweep[mine], span[mine]), low[own], tilt[own])
    tilt[~np.isfinite(tilt)] = 0.0
    largest = _largest_tilt(motion)
    slack = largest * reach_of_tool_mm + (1e-7 if largest > 0.0 else 0.0)
    heads = [np.array(a, dtype=np.int64) for a in (first_piece, piece_count, first_node, leaves)]
    return Trees(sweep, span, *heads, node_box, last, box, slack, low, tilt, largest)


def _pieces(motion: Motion, on_arc: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Sweep and span of each piece: whole lines, arcs in parts of less than `_PIECE_RAD`."""
    if not on_arc.any():
        span = np.empty((len(on_arc), 2))
        span[:] = 0.0, 1.0
        return np.arange(len(on_arc), dtype=np.int32), span
    parts = np.ones(len(on_arc), dtype=np.int64)
    parts[on_arc] = np.ceil(np.abs(motion.arcs[:, 4, 2]) / _PIECE_RAD)
    sweep = np.repeat(np.arange(len(parts), dtype=np.int32), parts)
    part = np.arange(len(sweep)) - np.repeat(np.cumsum(parts) - parts, parts)
    span = np.stack([part, part + 1], axis=1) / parts[sweep][:, None]
    return sweep, span


def _piece_boxes(motion: Motion, sweep: np.ndarray, span: np.ndarray) -> np.ndarray:
    box = np.empty((len(sweep), 6), dtype=np.float32)
    run_in_parts(lambda begin, end: _bound_pieces(motion, sweep, span, (begin, end), box), len(box))
    return box


@njit_kernel()
def _bound_pieces(motion, sweep, span, part, box):
    """Box of the displaced tip over each piece: of both ends, widened by the curvature."""
    for k in range(part[0], part[1]):
        start = tip_at(motion, sweep[k], span[k, 0])[0]
        end = tip_at(motion, sweep[k], span[k, 1])[0]
        # kept in single precision: half the memory to go through; widened by its rounding
        sagitta = bend_of(motion, sweep[k]) * (span[k, 1] - span[k, 0]) ** 2 / 8.0
        for j in range(3):
            low, high = min(start[j], end[j]) - sagitta, max(start[j], end[j]) + sagitta
            box[k, j] = low - _SINGLE * abs(low)
            box[k, 3 + j] = high + _SINGLE * abs(high)


def _largest_tilt(motion: Motion) -> float:
    if len(motion.tilt) == 0:
        return 0.0
    parts = (motion.tilt[k : k + _ROWS_AT_ONCE] for k in range(0, len(motion.tilt), _ROWS_AT_ONCE))
    return float(max(np.abs(part).sum(axis=1).max() for part in parts))


@njit_kernel()
def _fill_nodes(pieces, box, last):
    """Bound the leaves, then each node from its two children."""
    piece_box, piece_sweep = pieces
    leaves = len(last) // 2
    for k in range(len(piece_sweep)):
        node = leaves + k // LEAF
        last[node] = max(last[node], piece_sweep[k])
        for j in range(3):
            box[node, j] = min(box[node, j], piece_box[k, j])
            box[node, 3 + j] = max(box[node, 3 + j], piece_box[k, 3 + j])
    for node in range(leaves - 1, 0, -1):
        last[node] = max(last[2 * node], last[2 * node + 1])
        for j in range(3):
            box[node, j] = min(box[2 * node, j], box[2 * node + 1, j])
            box[node, 3 + j] = max(box[2 * node, 3 + j], box[2 * node + 1, 3 + j])


@njit_kernel()
def _fill_floors(motion, pieces, low, tilt):
    """How low the tips of the leaves come, and their tilts; then those of each node."""
    sweep, span = pieces
    leaves = len(low) // 2
    for k in range(len(sweep)):
        i, node = sweep[k], leaves + k // LEAF
        sagitta = bend_of_height(motion, i, 0.0) * (span[k, 1] - span[k, 0]) ** 2 / 8.0
        ends = tip_at(motion, i, span[k, 0])[0][2], tip_at(motion, i, span[k, 1])[0][2]
        low[node] = min(low[node], min(ends) - sagitta)
        for j in range(2 if len(tilt) else 0):
            least, most = _range_of_cubic(motion.tilt, i, j)
            tilt[node, j] = min(tilt[node, j], least - _SINGLE * abs(least))
            tilt[node, 2 + j] = max(tilt[node, 2 + j], most + _SINGLE * abs(most))
    for node in range(leaves - 1, 0, -1):
        low[node] = min(low[2 * node], low[2 * node + 1])
        for j in range(2 if len(tilt) else 0):
            tilt[node, j] = min(tilt[2 * node, j], tilt[2 * node + 1, j])
            tilt[node, 2 + j] = max(tilt[2 * node, 2 + j], tilt[2 * node + 1, 2 + j])


@njit_inlined()
def _range_of_cubic(a, i, j):
    """Bounds of component j of cubic i over [0, 1]: its Bezier points hold it between them."""
    first = a[i, j]
    second = first + a[i, 3 + j] / 3.0
    third = first + (2.0 * a[i, 3 + j] + a[i, 6 + j]) / 3.0
    last = first + a[i, 3 + j] + a[i, 6 + j] + a[i, 9 + j]
    return min(first, second, third, last), max(first, second, third, last)


@njit_inlined()
def bound_of_node(outlines, trees, tool, k, q):
    """Least distance of point `q` from the tool at any place of node `k`."""
    bound = _bound_of_box(outlines, tool, trees.box, k, q) - trees.slack_mm[tool]
    return max(bound, _below_tips(outlines, trees, tool, k, q))


@njit_inlined()
def bound_of_piece(outlines, trees, tool, k, q):
    """Least distance of point `q` from the tool at any place of piece `k`."""
    return _bound_of_box(outlines, tool, trees.piece_box, k, q) - trees.slack_mm[tool]


@njit_inlined()
def _bound_of_box(outlines, tool, box, k, q):
    """Least distance of point `q` from the upright tool with its tip anywhere in box `k`."""
    dx = max(box[k, 0] - q[0], 0.0, q[0] - box[k, 3])
    dy = max(box[k, 1] - q[1], 0.0, q[1] - box[k, 4])
    return lower_bound(outlines, tool, math.sqrt(dx * dx + dy * dy), q[2] - box[k, 2])


@njit_inlined()
def _below_tips(outlines, trees, tool, k, q):
    """How far point `q` is at least below the lowest plane of the tool, anywhere in node `k`.

    With y from the tip to q, the height above that plane is y_z - (tilt x y)_z but for the square
    of the tilt.
    """
    below = trees.low_mm[k] - q[2] - outlines.edges[outlines.first_edge[tool], 2]
    if len(trees.tilt) == 0:
        return below
    box, tilt = trees.box, trees.tilt
    x0, x1 = q[0] - box[k, 3], q[0] - box[k, 0]
    y0, y1 = q[1] - box[k, 4], q[1] - box[k, 1]
    a0, b0, a1, b1 = tilt[k, 0], tilt[k, 1], tilt[k, 2], tilt[k, 3]
    rise = min(a0 * y0, a0 * y1, a1 * y0, a1 * y1) - max(b0 * x0, b0 * x1, b1 * x0, b1 * x1)
    far = max(-x0, x1, 0.0) + max(-y0, y1, 0.0) + abs(below)
    return below + rise - 2.0 * trees.largest_tilt**2 * far


@njit_inlined()
def pieces_of_leaf(trees, tool, node):
    """Begin and end of a leaf's pieces."""
    begin = trees.first_piece[tool] + LEAF * (node - trees.leaves[tool])
    return begin, min(begin + LEAF, trees.first_piece[tool] + trees.piece_count[tool])


def morton_order(points: np.ndarray) -> np.ndarray:
    """Order of points (K, 3) along a Morton curve: neighbours in space become neighbours."""
    if len(points) == 0:
        return np.zeros(0, dtype=np.int64)
    points = read_only(np.asarray(points, dtype=np.float64))
    low = points.min(axis=0)
    size = float((points.max(axis=0) - low).max())
    codes = np.empty(len(points), dtype=np.uint64)
    _fill_morton_codes(codes, points, low, 0.0 if size == 0.0 else 65535.0 / size)
    return np.argsort(codes, kind="stable")


def _order_of_boxes(box: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """`morton_order` of the centres of some boxes, without room for all centres."""
    if len(rows) == 0:
        return np.zeros(0, dtype=np.int64)
    ends = np.empty((2, 3))
    _fill_ends_of_centres(ends, box, rows)
    size = float((ends[1] - ends[0]).max())
    codes = np.empty(len(rows), dtype=np.uint64)
    _fill_codes_of_boxes(codes, (box, rows), ends[0], 0.0 if size == 0.0 else 65535.0 / size)
    return np.argsort(codes, kind="stable")


@njit_kernel()
def _fill_ends_of_centres(ends, box, rows):
    ends[0], ends[1] = np.inf, -np.inf
    for i in rows:
        for j in range(3):
            centre = 0.5 * (box[i, j] + box[i, 3 + j])
            ends[0, j], ends[1, j] = min(ends[0, j], centre), max(ends[1, j], centre)


@njit_kernel()
def _fill_codes_of_boxes(codes, boxes, low, scale):
    box, rows = boxes
    for k in range(len(rows)):
        code = np.uint64(0)
        for j in range(3):
            centre = 0.5 * (box[rows[k], j] + box[rows[k], 3 + j])
            code |= _spread(np.uint64((centre - low[j]) * scale)) << np.uint64(j)
        codes[k] = code


@njit_kernel()
def _fill_morton_codes(codes, points, low, scale):
    for i in range(len(points)):
        code = np.uint64(0)
        for j in range(3):
            code |= _spread(np.uint64((points[i, j] - low[j]) * scale)) << np.uint64(j)
        codes[i] = code


@njit_inlined()
def _spread(bits):
    """Put two zero bits behind each of the 16 lowest bits."""
    bits = (bits | (bits << np.uint64(32))) & np.uint64(0x1F00000000FFFF)
    bits = (bits | (bits << np.uint64(16))) & np.uint64(0x1F0000FF0000FF)
    bits = (bits | (bits << np.uint64(8))) & np.uint64(0x100F00F00F00F00F)
    bits = (bits | (bits << np.uint64(4))) & np.uint64(0x10C30C30C30C30C3)
    return (bits | (bits << np.uint64(2))) & np.uint64(0x1249249249249249)
