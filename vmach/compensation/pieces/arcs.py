"""Arcs that stay arcs: the fewest that pass the corrected points.

Source: closed form derived here: the circle through three points; a helix adds a straight rise.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from numba import njit

from gcode import Moves
from vmach.path.geometry import position_at
from vmach.program_text import Piece
from vmach.program_text.blocks.circles import circle_centre, length

__all__ = ["LARGEST_SWEEP_RAD", "circle_misses", "split_arc"]

#: an arc is cut into arcs of no more than this, so that start and end stay apart
LARGEST_SWEEP_RAD = np.radians(181.0)


def split_arc(
    moves: Moves,
    move: int,
    parameter: np.ndarray,
    correction_mm: np.ndarray,
    *,
    tolerance_mm: float,
) -> Iterator[Piece]:
    """Cut an arc into arcs, each as long as the tolerance allows.

    Every arc passes the corrected points at its ends and its middle. What is left is the third
    order of the error along the arc, odd about the middle, so that this is nearly the best arc.

    Parameters
    ----------
    moves : Moves
    move : int
    parameter : (n,) float64
        Samples of the move.
    correction_mm : (n, 3) float64
    tolerance_mm : float
        Largest distance of the samples from the arc.
    """
    nominal = position_at(moves, np.full(len(parameter), move), parameter)
    points, axis = nominal + correction_mm, moves.axis[move]
    sweep = abs(moves.sweep_rad[move]) * (parameter - parameter[0])
    last, here = len(parameter) - 1, 0
    while here < last:
        most = int(np.searchsorted(sweep, sweep[here] + LARGEST_SWEEP_RAD, side="right")) - 1
        fits = partial(_fits, points, parameter, axis, tolerance_mm, here)
        stop = here + 2 * _farthest(fits, 1, (most - here) // 2)
        stop = last if stop + 1 >= last and sweep[last] - sweep[here] <= LARGEST_SWEEP_RAD else (
            min(stop, last))  # fmt: skip
        yield Piece(move, float(parameter[here]), float(parameter[stop]), is_arc=True)
        here = stop


def _fits(
    points: np.ndarray, parameter: np.ndarray, axis: np.ndarray, tolerance_mm: float, here: int,
    half: int,
) -> bool:  # fmt: skip
    """Whether samples ``here`` to ``here + 2 * half`` are within tolerance of one arc."""
    part = slice(here, here + 2 * half + 1)
    return half <= 1 or _circle_miss(points[part], parameter[part], axis) <= tolerance_mm


def _farthest(fits: Callable[[int], bool], good: int, most: int) -> int:
    """Largest number that fits, by bisection from one that does."""
    if good >= most or fits(most):
        return max(good, most)
    while most - good > 1:
        middle = (good + most) // 2
        good, most = (middle, most) if fits(middle) else (good, middle)
    return good


def _circle_miss(points: np.ndarray, parameter: np.ndarray, axis: np.ndarray) -> float:
    """Largest distance of points (K, 3) from the helix through first, middle and last."""
    return float(circle_misses(points, parameter, np.array([0, len(points)]), axis[None])[0])


@njit(cache=True)
def circle_misses(points, parameter, first, axes):  # pragma: no cover - compiled
    """Largest distance of samples from the helix through the first, middle and last of each arc.

    Parameters
    ----------
    points : (P, 3) float64
    parameter : (P,) float64
        Increasing along every arc.
    first : (A + 1,) int64
        Samples of arc k are ``first[k]`` to ``first[k + 1] - 1``.
    axes : (A, 3) float64
        Along an axis of the machine.

    Returns
    -------
    (A,) float64
        Infinite where the three points are in line.
    """
    found = np.full(len(axes), np.inf)
    for k in range(len(axes)):
        begin, last = first[k], first[k + 1] - 1
        normal = np.argmax(np.abs(axes[k]))
        u, v = (1 if normal == 0 else 0), (1 if normal == 2 else 2)
        flat = np.empty((3, 2))
        for n, row in enumerate((begin, begin + (last + 1 - begin) // 2, last)):
            flat[n, 0], flat[n, 1] = points[row, u], points[row, v]
        is_circle, x, y = circle_centre(flat[0], flat[1], flat[2])
        if not is_circle:
            continue
        radius, worst = length(flat[0, 0] - x, flat[0, 1] - y), 0.0
        low, high = points[begin] @ axes[k], points[last] @ axes[k]
        span = parameter[last] - parameter[begin]
        for row in range(begin, last + 1):
            share = (parameter[row] - parameter[begin]) / span
            off = points[row] @ axes[k] - (low + share * (high - low))
            worst = max(worst, length(length(points[row, u] - x, points[row, v] - y) - radius, off))
        found[k] = worst
    return found
