"""Bounding-volume trees over sweeps, one a tool, for finding the sweeps near a point.

A node holds the box of the displaced tool tip, not of the swept tool. The outline itself bounds
from below the distance of a point from a tool whose tip is anywhere in the box. So a query
reaches only the sweeps that are really near, however large the tool is.

Source: closed form derived here: a distance to a box bounds the distance to all that is in it
from below.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from stock.compiled import njit_inlined, njit_kernel, read_only
from stock.exact.motion import Motion, bend_of, on_arcs, tip_at, tools_of
from stock.exact.outline import lower_bound
from stock.threads import run_in_parts

__all__ = ["Trees", "bound_of_box", "build_trees", "morton_order", "pieces_of_leaf"]

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
    for t in range(len(leaves)):
        of_tool = slice(first_piece[t], first_piece[t] + piece_count[t])
        nodes_of_tool = slice(first_node[t], first_node[t] + 2 * leaves[t])
        _fill_nodes(box[of_tool], sweep[of_tool], node_box[nodes_of_tool], last[nodes_of_tool])
    tilt = _largest_tilt(motion)
    slack = tilt * reach_of_tool_mm + (1e-7 if tilt > 0.0 else 0.0)
    heads = [np.array(a, dtype=np.int64) for a in (first_piece, piece_count, first_node, leaves)]
    return Trees(sweep, span, *heads, node_box, last, box, slack)


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
def _fill_nodes(piece_box, piece_sweep, box, last):
    """Bound the leaves, then each node from its two children."""
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


@njit_inlined()
def bound_of_box(outlines, tool, box, k, q):
    """Least distance of point `q` from the tool with its tip anywhere in box `k`."""
    dx = max(box[k, 0] - q[0], 0.0, q[0] - box[k, 3])
    dy = max(box[k, 1] - q[1], 0.0, q[1] - box[k, 4])
    return lower_bound(outlines, tool, math.sqrt(dx * dx + dy * dy), q[2] - box[k, 2])


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
