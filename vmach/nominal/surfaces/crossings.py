"""Compiled crossings of the edges of a face with lines of constant u or v."""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["INSIDE", "MEETS_NO_EDGE", "OUTSIDE", "line_crossings", "sides_of_points"]

OUTSIDE, INSIDE, MEETS_NO_EDGE = 0, 1, 2


@njit(cache=True, nogil=True)
def _crossing(start, end, axis, value, period):
    """Whether a segment crosses uv[axis] = value, the other coordinate there, and if upwards.

    With a period, `value` stands for all that differ from it by whole turns; a segment is shorter
    than half of one.
    """
    low, high = start[axis] - value, end[axis] - value
    if period > 0.0:
        low_side, high_side = np.floor(low / period), np.floor(high / period)
    else:
        low_side, high_side = 1.0 if low >= 0.0 else 0.0, 1.0 if high >= 0.0 else 0.0
    if low_side == high_side:
        return False, 0.0, False
    target = value + period * max(low_side, high_side)
    share = (target - start[axis]) / (end[axis] - start[axis])
    other = start[1 - axis] + share * (end[1 - axis] - start[1 - axis])
    return True, other, high_side > low_side


@njit(cache=True, nogil=True)
def line_crossings(segments, axis, value, period):
    """Where segments (S, 2, 2) cross uv[axis] = value: the other coordinate, and if upwards."""
    other, upward = np.empty(len(segments)), np.empty(len(segments), dtype=np.bool_)
    count = 0
    for s in range(len(segments)):
        crosses, place, up = _crossing(segments[s, 0], segments[s, 1], axis, value, period)
        if crosses:
            other[count], upward[count] = place, up
            count += 1
    return other[:count].copy(), upward[:count].copy()


@njit(cache=True, nogil=True)
def sides_of_points(segments, uv, u_period, v_period):
    """For each point (N, 2): INSIDE, OUTSIDE, or MEETS_NO_EDGE where no edge crosses its row.

    The nearest edge towards +u decides: inside where the face ends there.
    """
    sides = np.empty(len(uv), dtype=np.int8)
    for n in range(len(uv)):
        nearest, side, meets = np.inf, OUTSIDE, False
        for s in range(len(segments)):
            crosses, u, up = _crossing(segments[s, 0], segments[s, 1], 1, uv[n, 1], v_period)
            if not crosses:
                continue
            meets = True
            ahead = u - uv[n, 0]
            if u_period > 0.0:
                ahead = ahead % u_period
            if 0.0 <= ahead < nearest:
                nearest, side = ahead, INSIDE if up else OUTSIDE
        sides[n] = side if meets else MEETS_NO_EDGE
    return sides
