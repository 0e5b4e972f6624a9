"""Walk along each surface normal from the nominal surface to the edge of the material.

Source: closed form derived here: along a line air is extended by each sweep that it meets, until
none adds to it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stock.compiled import njit_inlined, njit_kernel, njit_part
from stock.exact.crossing import entry, exit_below
from stock.exact.meeting import TOUCH_MM, Cut, Meeting, point_at
from stock.exact.motion import bend_of_height, tool_of
from stock.exact.sweep_distance import start_of_search, sweep_distance
from stock.exact.tool_frame import seen_from_tool
from stock.exact.tree import (
    Trees,
    bound_of_node,
    bound_of_piece,
    morton_order,
    pieces_of_leaf,
)
from stock.threads import run_in_parts

__all__ = ["CUT", "GOUGED", "UNCUT", "Work", "walk_lines", "walk_part"]

CUT, UNCUT, GOUGED = 0, 1, 2
_STACK = 128
#: pieces that a walk looks at before it asks whether any holds the start at all: in the midst of
#: moves that are short beside their tools, thousands are near
_MANY = 48
#: lines whose walks help each other: each begins with the piece that the one before ended on
_COMPANY = 64


class Work(NamedTuple):
    """All that the kernels know of the job."""

    cut: Cut
    trees: Trees


def walk_lines(work, points, normals, blank, reach):
    """Find the material's edge on every line.

    Parameters
    ----------
    work : Work
    points, normals : (P, 3) float64
    blank : (2, 3) float64
        Corners of the blank, infinite where there is none.
    reach : float

    Returns
    -------
    status : (P,) uint8
    edge, parameter : (P,) float64
        h, and s on the sweep.
    sweep : (P,) int64
    """
    count = len(points)
    found = (
        np.full(count, UNCUT, dtype=np.uint8),
        np.zeros(count),
        np.zeros(count),
        np.full(count, -1),
    )
    order = morton_order(points)  # neighbours use the same nodes of the tree
    run_in_parts(
        lambda begin, end: walk_part(
            work, (points, normals, order[begin:end]), (blank, reach), _nodes_to_visit(), found
        ),
        count,
        block=_COMPANY,
    )
    return found


def _nodes_to_visit():
    """Room for the nodes that one search still has to visit, their bounds, and its hint.

    The second half is for a search within a search.
    """
    return np.empty(2 * _STACK, np.int64), np.empty(2 * _STACK), np.empty(1, np.int64)


@njit_kernel()
def walk_part(work, lines, bounds, todo, found):
    """Walk along the lines `order`; `hint` is the piece to look at first."""
    points, normals, order = lines
    status, edge, parameter, sweep = found
    blank, reach = bounds
    hint = todo[2]
    for place in range(len(order)):
        if place % _COMPANY == 0:
            hint[0] = -1
        i = order[place]
        p = (points[i, 0], points[i, 1], points[i, 2])
        n = (normals[i, 0], normals[i, 1], normals[i, 2])
        state, h, which, s = _walk(work, (p, n), _blank_interval(blank, p, n), reach, todo)
        status[i] = state
        if state == CUT:
            edge[i], sweep[i], parameter[i] = h, which, s


@njit_part()
def _walk(work, line, blank, reach, todo):
    """State, h, sweep and s of one line; `blank` is the part of it in the blank."""
    if blank[0] > TOUCH_MM or blank[1] < -reach:
        return GOUGED, 0.0, -1, 0.0
    h, sweep, s = blank[1], -1, 0.0
    if h >= -TOUCH_MM:
        inside, h, sweep, s = _walk_out(work, line, min(reach, max(blank[1], 0.0)), todo)
        if not inside:
            return (CUT if sweep >= 0 else UNCUT), h, sweep, s
        h = 0.0
        # often the sweep that the line begins in is all that there is to see
        if exit_below(_meeting(work, todo[2][0], line), h, -reach)[0] <= -reach:
            return GOUGED, 0.0, -1, 0.0
    before = np.inf
    while -reach < h < before:  # until a pass finds no more air
        before = h
        h, sweep, s = _pass_in(work, line, (h, sweep, s), reach, todo)
    if h <= -reach or h <= blank[0] + TOUCH_MM:
        return GOUGED, 0.0, -1, 0.0
    return (CUT if sweep >= 0 else UNCUT), h, sweep, s


@njit_part()
def _blank_interval(blank, p, n):
    """The h between which the line is in the blank, grazing its faces included."""
    low, high = -np.inf, np.inf
    for j in range(3):
        if abs(n[j]) < 1e-12:
            if not blank[0, j] - TOUCH_MM <= p[j] <= blank[1, j] + TOUCH_MM:
                return np.inf, -np.inf
        else:
            a, b = (blank[0, j] - p[j]) / n[j], (blank[1, j] - p[j]) / n[j]
            low, high = max(low, min(a, b)), min(high, max(a, b))
    if low > high + TOUCH_MM:
        return np.inf, -np.inf
    return low, high


@njit_part()
def _walk_out(work, line, most, todo):
    """Nearest entry into any sweep going outwards; whether the start is inside one instead."""
    cut, trees = work
    q, hint = line[0], todo[2]
    best, best_sweep, best_s, asked = most, -1, 0.0, 0
    if hint[0] >= 0:  # near the end of the search at once
        sweep = trees.sweep[hint[0]]
        h, s = entry(_meeting(work, hint[0], line), best)
        if h == -np.inf:
            return True, 0.0, -1, 0.0
        if h <= best:
            best, best_sweep, best_s = h, sweep, s
    for tool in range(len(trees.leaves)):
        root, leaves = trees.first_node[tool], trees.leaves[tool]
        top = _begin(todo)
        while top > 0:
            top -= 1
            node, bound = todo[0][top], todo[1][top]
            if _useless(bound, trees.last[root + node], best, best_sweep):
                continue
            if node < leaves:
                top = _push_children(work, tool, q, node, (todo, top, 0.0))
                continue
            begin, end = pieces_of_leaf(trees, tool, node)
            for k in range(begin, end):
                sweep = trees.sweep[k]
                bound = bound_of_piece(cut.outlines, trees, tool, k, q)
                if _useless(bound, sweep, best, best_sweep):
                    continue
                if _useless(_below_piece(work, k, line, 0.0), sweep, best, best_sweep):
                    continue
                asked += 1
                if asked == _MANY and _is_inside(work, line, todo):
                    return True, 0.0, -1, 0.0
                h, s = entry(_meeting(work, k, line), best)
                if h == -np.inf:
                    hint[0] = k
                    return True, 0.0, -1, 0.0
                if h < best - TOUCH_MM or (h <= best + TOUCH_MM and sweep > best_sweep):
                    best, best_sweep, best_s = min(h, best), sweep, s
                    hint[0] = k
    return False, best, best_sweep, best_s


@njit_part()
def _is_inside(work, line, todo):
    """Whether any sweep holds the line's point at 0; the piece that does becomes the hint."""
    cut, trees = work
    q, (nodes, bounds, hint) = line[0], todo
    for tool in range(len(trees.leaves)):
        leaves = trees.leaves[tool]
        nodes[_STACK], bounds[_STACK], top = 1, -np.inf, _STACK + 1
        while top > _STACK:
            top -= 1
            node = nodes[top]
            if bounds[top] > 0.0:
                continue
            if node < leaves:
                top = _push_children(work, tool, q, node, (todo, top, 0.0))
                continue
            begin, end = pieces_of_leaf(trees, tool, node)
            for k in range(begin, end):
                if bound_of_piece(cut.outlines, trees, tool, k, q) > 0.0:
                    continue
                meeting = _meeting(work, k, line)
                s = start_of_search(meeting, 0.0)
                if sweep_distance(meeting, 0.0, s, TOUCH_MM).mm < -TOUCH_MM:
                    hint[0] = k
                    return True
    return False


@njit_inlined()
def _meeting(work, k, line):
    """A line and the piece k of the trees."""
    cut, trees = work
    return Meeting(cut, trees.sweep[k], (trees.span[k, 0], trees.span[k, 1]), line)


@njit_inlined()
def _below_piece(work, k, line, h):
    """How far the line's point at h is at least below the tool's lowest plane, all along piece k.

    Its height above that plane bends by no more than the sweep does.
    """
    cut, trees = work
    meeting = _meeting(work, k, line)
    low, high = meeting.span
    at_low = seen_from_tool(meeting, h, low)[0][2]
    at_high = seen_from_tool(meeting, h, high)[0][2]
    bend = bend_of_height(cut.motion, meeting.sweep, trees.largest_tilt)
    edge = cut.outlines.first_edge[tool_of(cut.motion, meeting.sweep)]
    return -max(at_low, at_high) - cut.outlines.edges[edge, 2] - bend * (high - low) ** 2 / 8.0


@njit_inlined()
def _useless(bound, last, best, best_sweep):
    """Nothing at this distance can be nearer, or equally near and cut later."""
    return bound > best + TOUCH_MM or (bound > best - TOUCH_MM and last <= best_sweep)


@njit_inlined()
def _begin(todo):
    """Put the root on the list of nodes still to visit."""
    todo[0][0], todo[1][0] = 1, -np.inf
    return 1


@njit_inlined()
def _push_children(work, tool, q, node, place):
    """Put both children on the list, the nearer or later one on top, a constant added to bounds."""
    (nodes, bounds, _), top, constant = place
    cut, trees = work
    first = trees.first_node[tool] + 2 * node
    left = bound_of_node(cut.outlines, trees, tool, first, q) + constant
    right = bound_of_node(cut.outlines, trees, tool, first + 1, q) + constant
    if right < left or (right == left and trees.last[first + 1] > trees.last[first]):
        nodes[top], bounds[top], nodes[top + 1], bounds[top + 1] = (
            2 * node,
            left,
            2 * node + 1,
            right,
        )
    else:
        nodes[top], bounds[top], nodes[top + 1], bounds[top + 1] = (
            2 * node + 1,
            right,
            2 * node,
            left,
        )
    return top + 2


@njit_part()
def _pass_in(work, line, state, reach, todo):
    """One way through the trees that extends the air at h by every sweep met on it.

    The listed bounds were taken at the h of then; going inwards since has lowered them by no
    more than the way, so that bound - h then + h now is a bound now.
    """
    h, best_sweep, best_s = state
    cut, trees = work
    for tool in range(len(trees.leaves)):
        leaves = trees.leaves[tool]
        top = _begin(todo)
        while top > 0:
            top -= 1
            node = todo[0][top]
            if todo[1][top] + h > TOUCH_MM:
                continue
            if node < leaves:
                top = _push_children(work, tool, point_at(line, h), node, (todo, top, -h))
                continue
            begin, end = pieces_of_leaf(trees, tool, node)
            for k in range(begin, end):
                if bound_of_piece(cut.outlines, trees, tool, k, point_at(line, h)) > TOUCH_MM:
                    continue
                if _below_piece(work, k, line, h) > TOUCH_MM:
                    continue
                sweep = trees.sweep[k]
                lower, s, is_touch = exit_below(_meeting(work, k, line), h, -reach)
                if lower < h:
                    h, best_sweep, best_s = lower, sweep, s
                    todo[2][0] = k
                    if h <= -reach:
                        return h, best_sweep, best_s
                elif is_touch and sweep > best_sweep:
                    best_sweep, best_s = sweep, s
    return h, best_sweep, best_s
