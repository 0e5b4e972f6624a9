"""Ends rounded together: of the grid points around every end, those that serve the path best."""

from __future__ import annotations

from itertools import product

import numpy as np
from numba import njit

from gcode import MoveKind
from vmach.compensation.plan import Plan
from vmach.path_geometry import position_at, tangent_at
from vmach.program_text import Rewriter, Target

__all__ = ["rounded_target"]

#: corners of the cell of the grid that an end lies in
_CORNERS = np.array(list(product((0.0, 1.0), repeat=3)))
#: weight of the fourth power of the distance beside the second, in steps: keeps the largest small
_LARGE = 1.0
#: weight of the whole distance of an end, beside that across the moves that meet there
_ALONG = 0.15
#: an axis that moves by no more stands, and keeps its place by this weight
_STANDING_MM = 2e-7
_TIE = 1e6


def rounded_target(rewriter: Rewriter, plan: Plan, target: Target, resolution_mm: float) -> Target:
    """The target with ends on the grid of the words X Y Z.

    Rounding an end to the nearest point moves the tool across the path by up to 0.7 steps. Of
    the eight points around it another may be better, because what counts is the distance across
    the two moves that meet there, all along them: the error of a straight move goes linearly
    from one end's to the other's. The best sequence is found by dynamic programming.

    Parameters
    ----------
    rewriter : Rewriter
    plan : Plan
    target : Target
        With ends anywhere.
    resolution_mm : float
    """
    moves, move, angle = rewriter.moves, plan.move, rewriter.angle[plan.move]
    nominal = position_at(moves, move, plan.parameter(1.0))
    nominal = rewriter.end_mm[move] + _turned(nominal - moves.end_mm[move], -angle)
    step = _steps(rewriter, plan, resolution_mm)[:, None]
    wanted = (nominal + _turned(target.ends_mm, -angle)) / step
    corner = np.floor(wanted)[:, None] + _CORNERS
    off = _turned(((corner - wanted[:, None]) * step[:, None]).reshape(-1, 3), np.repeat(angle, 8))
    off = off.reshape(-1, 8, 3)
    first, last = plan.parameter(0.0), plan.parameter(1.0)
    feed = (moves.kind[move] != MoveKind.RAPID) & ~plan.is_step
    length = np.where(feed, (last - first) * rewriter.length_mm[move], 0.0)
    tangents = [_unit(tangent_at(moves, move, at)) for at in (first, last)]
    still = _axes_that_stand(rewriter, plan, target)
    best = _best_corners(off / step[:, None], *tangents, length, still)
    found = target.ends_mm + off[np.arange(len(best)), best]
    found[plan.is_kept] = target.ends_mm[plan.is_kept]
    return Target(target.pieces, found, target.middles_mm)


def _axes_that_stand(rewriter: Rewriter, plan: Plan, target: Target) -> np.ndarray:
    """Axes that do not move in a piece and so get no word in it, (K, 3) bool."""
    place = position_at(rewriter.moves, plan.move, plan.parameter(1.0)) + target.ends_mm
    start = rewriter.moves.start_mm[plan.move[1:]]
    inside = plan.move[1:] == plan.move[:-1]
    before = np.where(inside[:, None], place[:-1], start + target.ends_mm[:-1])
    still = np.zeros(place.shape, bool)
    still[1:] = np.abs(place[1:] - before) < _STANDING_MM
    still[rewriter.angle[plan.move] != 0.0] = False
    return still


def _steps(rewriter: Rewriter, plan: Plan, resolution_mm: float) -> np.ndarray:
    """Step of the words of every piece, (K,) mm."""
    units = {}
    for move in set(plan.move.tolist()):
        units[move] = rewriter.modes[int(rewriter.moves.line[move])].unit_mm
    return np.array(
        [units[k] * 10.0 ** -rewriter.control.decimals(resolution_mm, units[k]) for k in plan.move]
    )


def _turned(vectors: np.ndarray, angle_rad: np.ndarray) -> np.ndarray:
    """Vectors (K, 3) turned about Z."""
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    x, y, z = vectors.T
    return np.column_stack([cos * x - sin * y, sin * x + cos * y, z])


def _unit(vectors: np.ndarray) -> np.ndarray:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0)


@njit(cache=True)
def _best_corners(off, first_tangent, last_tangent, length, still):
    """Corner of every end, (K,), so that the sum of costs along the path is smallest."""
    count = len(off)
    total = np.zeros(8)
    came_from = np.zeros((count, 8), np.int64)
    for k in range(count):
        now = np.full(8, np.inf)
        for b in range(8):
            along = _ALONG * (0.1 + length[k]) * (off[k, b] ** 2).sum() ** 2
            for a in range(8):
                before = off[k - 1, a] if k else np.zeros(3)
                cost = total[a] + along
                cost += _TIE * (still[k] * (off[k, b] - before) ** 2).sum()
                if length[k] > 0.0:
                    cost += length[k] * _cost(before, off[k, b], first_tangent[k], last_tangent[k])
                if cost < now[b]:
                    now[b], came_from[k, b] = cost, a
        total = now - now.min()
    best = np.zeros(count, np.int64)
    corner = np.argmin(total)
    for k in range(count - 1, -1, -1):
        best[k] = corner
        corner = came_from[k, corner]
    return best


@njit(cache=True)
def _cost(before, after, first_tangent, last_tangent):
    """Mean cost of the distance across a move whose ends are off by this much, in steps."""
    one = before - (before * first_tangent).sum() * first_tangent
    two = after - (after * last_tangent).sum() * last_tangent
    cost = 0.0
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        square = (((1.0 - share) * one + share * two) ** 2).sum()
        cost += 0.2 * (square + _LARGE * square**2)
    return cost
