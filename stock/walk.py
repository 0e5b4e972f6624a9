"""Walk along each surface normal from the nominal surface to the edge of the material."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stock.compiled import inlined, kernel, unowned
from stock.contact import TOUCH_MM, entry, exit_below
from stock.motion import Motion
from stock.outline import Outlines
from stock.threads import run_in_parts
from stock.tree import LEAF, Trees, morton_order, node_bound

__all__ = ["CUT", "GOUGED", "UNCUT", "Work", "walk_lines"]

CUT, UNCUT, GOUGED = 0, 1, 2
_STACK = 128


class Work(NamedTuple):
    """All that the kernels know of the job."""

    motion: Motion
    tool: np.ndarray
    outlines: Outlines
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
        lambda begin, end: _walk_part(
            work, points, normals, order[begin:end], (blank, reach), found
        ),
        count,
    )
    return found


@kernel()
def _walk_part(work, points, normals, order, bounds, found):
    status, edge, parameter, sweep = found
    blank, reach = bounds
    work = unowned(work)
    for i in order:
        p = (points[i, 0], points[i, 1], points[i, 2])
        n = (normals[i, 0], normals[i, 1], normals[i, 2])
        state, h, which, s = _walk(work, (p, n), _blank_interval(blank, p, n), reach)
        status[i] = state
        if state == CUT:
            edge[i], sweep[i], parameter[i] = h, which, s


@kernel()
def _walk(work, line, blank, reach):
    """State, h, sweep and s of one line; `blank` is the part of it in the blank."""
    if blank[0] > TOUCH_MM or blank[1] < -reach:
        return GOUGED, 0.0, -1, 0.0
    h, sweep, s = 0.0, -1, 0.0
    inside = blank[1] < -TOUCH_MM
    if inside:
        h = blank[1]
    else:
        inside, h, sweep, s = _walk_out(work, line, min(reach, max(blank[1], 0.0)))
        if not inside:
            return (CUT if sweep >= 0 else UNCUT), h, sweep, s
        h = 0.0
    h, sweep, s = _walk_in(work, line, h, reach)
    if h <= -reach or h < blank[0]:
        return GOUGED, 0.0, -1, 0.0
    return (CUT if sweep >= 0 else UNCUT), h, sweep, s


@kernel()
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


@kernel()
def _walk_out(work, line, most):
    """Nearest entry into any sweep going outwards; whether the start is inside one instead."""
    best, best_sweep, best_s = most, -1, 0.0
    trees, q = work.trees, line[0]
    stack = np.empty(_STACK, dtype=np.int64)
    for tool in range(len(trees.leaves)):
        root, leaves, slack = trees.first_node[tool], trees.leaves[tool], trees.slack_mm[tool]
        stack[0], top = 1, 1
        while top > 0:
            top -= 1
            node = stack[top]
            bound = node_bound(work.outlines, tool, trees.box, root + node, q) - slack
            if _useless(bound, trees.last[root + node], best, best_sweep):
                continue
            if node < leaves:
                top = _push_children(work, tool, q, node, stack, top)
                continue
            begin = trees.first_piece[tool] + LEAF * (node - leaves)
            end = min(begin + LEAF, trees.first_piece[tool] + trees.piece_count[tool])
            for k in range(begin, end):
                sweep = trees.sweep[k]
                bound = node_bound(work.outlines, tool, trees.piece_box, k, q) - slack
                if _useless(bound, sweep, best, best_sweep):
                    continue
                span = (trees.span[k, 0], trees.span[k, 1])
                h, s = entry(work, sweep, span, line, best)
                if h == -np.inf:
                    return True, 0.0, -1, 0.0
                if h < best - TOUCH_MM or (h <= best + TOUCH_MM and sweep > best_sweep):
                    best, best_sweep, best_s = min(h, best), sweep, s
    return False, best, best_sweep, best_s


@inlined()
def _useless(bound, last, best, best_sweep):
    """Nothing at this distance can be nearer, or equally near and cut later."""
    return bound > best + TOUCH_MM or (bound > best - TOUCH_MM and last <= best_sweep)


@kernel()
def _push_children(work, tool, q, node, stack, top):
    """Put both children on the stack, the nearer one on top."""
    box, first = work.trees.box, work.trees.first_node[tool] + 2 * node
    left = node_bound(work.outlines, tool, box, first, q)
    right = node_bound(work.outlines, tool, box, first + 1, q)
    nearer = 2 * node + (1 if right < left else 0)
    stack[top], stack[top + 1] = 4 * node + 1 - nearer, nearer
    return top + 2


@kernel()
def _walk_in(work, line, h, reach):
    """Follow overlapping sweeps inwards from h, in air, until material begins."""
    sweep, s = -1, 0.0
    while h > -reach:
        before = h
        h, sweep, s = _pass_in(work, line, (h, sweep, s), reach)
        if h == before:
            break
    return h, sweep, s


@kernel()
def _pass_in(work, line, state, reach):
    """One way through the trees that extends the air at h by every sweep met on it."""
    h, best_sweep, best_s = state
    p, n = line
    trees = work.trees
    stack = np.empty(_STACK, dtype=np.int64)
    for tool in range(len(trees.leaves)):
        root, leaves, slack = trees.first_node[tool], trees.leaves[tool], trees.slack_mm[tool]
        stack[0], top = 1, 1
        while top > 0:
            top -= 1
            node = stack[top]
            q = (p[0] + h * n[0], p[1] + h * n[1], p[2] + h * n[2])
            if node_bound(work.outlines, tool, trees.box, root + node, q) - slack > TOUCH_MM:
                continue
            if node < leaves:
                top = _push_children(work, tool, q, node, stack, top)
                continue
            begin = trees.first_piece[tool] + LEAF * (node - leaves)
            end = min(begin + LEAF, trees.first_piece[tool] + trees.piece_count[tool])
            for k in range(begin, end):
                q = (p[0] + h * n[0], p[1] + h * n[1], p[2] + h * n[2])
                if node_bound(work.outlines, tool, trees.piece_box, k, q) - slack > TOUCH_MM:
                    continue
                span = (trees.span[k, 0], trees.span[k, 1])
                lower, s, touch = exit_below(work, trees.sweep[k], span, line, h, -reach)
                if lower < h:
                    h, best_sweep, best_s = lower, trees.sweep[k], s
                    if h <= -reach:
                        return h, best_sweep, best_s
                elif touch and trees.sweep[k] > best_sweep:
                    best_sweep, best_s = trees.sweep[k], s
    return h, best_sweep, best_s
