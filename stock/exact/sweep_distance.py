"""psi(h): how far a line's point is from a piece of a sweep, the least phi(h, s) over s.

Along a straight sweep one descent finds it, unless phi is so level that the displacement's
micrometres decide. Along an arc there may be several valleys.

Source: closed form derived here: the least of phi(h, s) over s, one descent where phi is convex.
"""

from __future__ import annotations

import math

import numpy as np

from stock.compiled import njit_inlined, njit_part
from stock.exact.descent import ROOT_MM, descend
from stock.exact.meeting import Meeting, point_at
from stock.exact.motion import arc_of, ripple_of, tool_of
from stock.exact.tool_distance import tool_distance

__all__ = ["start_of_search", "sweep_distance"]

#: share of the piece that a valley of phi has to exceed to be searched for several minima
_VALLEY = 1.0 / 32.0
_PARTS = 8
#: nearer to the centre of a corner the curvature changes too fast to speak for the valley, mm
_CORNER_MM = 0.01


@njit_inlined()
def start_of_search(meeting, h):
    """A guess at the nearest s: exact for level lines and arcs about +-Z."""
    x = point_at(meeting.line, h)
    span, motion = meeting.span, meeting.cut.motion
    k = arc_of(motion, meeting.sweep)
    if k >= 0:
        s = _nearest_on_arc(motion.arcs, k, span, x)
    else:
        height = meeting.cut.outlines.height[tool_of(motion, meeting.sweep)]
        s = _nearest_on_line(motion.path, meeting.sweep, x, height)
        s = 0.5 * (span[0] + span[1]) if math.isnan(s) else s
    return min(max(s, span[0]), span[1])


@njit_inlined()
def _nearest_on_arc(a, k, span, x):
    """s of the arc's point in the direction of x, on the turn that the piece is on."""
    x = (x[0] - a[k, 0, 0], x[1] - a[k, 0, 1], x[2] - a[k, 0, 2])
    along = x[0] * a[k, 1, 0] + x[1] * a[k, 1, 1] + x[2] * a[k, 1, 2]
    across = x[0] * a[k, 2, 0] + x[1] * a[k, 2, 1] + x[2] * a[k, 2, 2]
    middle = 0.5 * (span[0] + span[1]) * a[k, 4, 2]
    turn = math.atan2(across, along) - middle
    turn -= 2.0 * math.pi * round(turn / (2.0 * math.pi))
    return (middle + turn) / a[k, 4, 2]


@njit_inlined()
def _nearest_on_line(c, i, x, height):
    """s of the straight sweep's point next to x; nan where the sweep goes nowhere.

    A point higher than the tool's lowest rounding is beside the tool: only the level way counts.
    """
    vx, vy, vz = c[i, 3], c[i, 4], c[i, 5]
    z = min(0.0, x[2] - c[i, 2] - height)
    if z == 0.0:
        vz = 0.0
    square = vx * vx + vy * vy + vz * vz
    along = (x[0] - c[i, 0]) * vx + (x[1] - c[i, 1]) * vy + z * vz
    return along / square if square > 0.0 else np.nan


@njit_part()
def sweep_distance(meeting, h, s, limit):
    """psi(h), as a `Nearest`.

    Parameters
    ----------
    meeting : Meeting
    h : float
    s : float
        Where to start.
    limit : float
        A bound above which psi is of no interest, mm.
    """
    best = descend(meeting, h, s, limit)
    if best.mm == np.inf:
        return best
    if arc_of(meeting.cut.motion, meeting.sweep) >= 0:
        for end in meeting.span:  # an arc can come nearest at either end
            if tool_distance(meeting, h, end).mm < best.mm:
                best = descend(meeting, h, end, limit)
    if not _is_level(meeting.cut.motion, meeting.sweep) or _has_valley(meeting, h, best.s):
        best = _lowest_of_parts(meeting, h, best, limit)
    return best


@njit_inlined()
def _is_level(motion, i):
    """Whether sweep i is a line, or an arc in a plane square to the tool axis.

    The distance from such an arc falls and rises once along it; from other arcs it may do so
    more often.
    """
    k, a = arc_of(motion, i), motion.arcs
    return k < 0 or (a[k, 1, 2] == 0.0 and a[k, 2, 2] == 0.0 and a[k, 3, 2] == 0.0)


@njit_inlined()
def _has_valley(meeting, h, s):
    """Whether phi is so level along s around its minimum that the displacement may ripple it."""
    low, high = meeting.span
    width = high - low
    ripple = ripple_of(meeting.cut.motion, meeting.sweep)
    if ripple * width * width < ROOT_MM:
        return False
    here = tool_distance(meeting, h, s)
    if here.by_ss > 10.0 * ripple and here.curvature * _CORNER_MM < 1.0:
        return False
    for step in (-_VALLEY * width, _VALLEY * width):
        if low < s + step < high:
            by_s = tool_distance(meeting, h, s + step).by_s
            if abs(by_s) <= 2.0 * ripple * width or by_s * step < 0.0:
                return True
    return False


@njit_part()
def _lowest_of_parts(meeting, h, best, limit):
    """Look for a lower minimum in each part of the piece that can have one."""
    cut, sweep, (low, high), line = meeting
    width = (high - low) / _PARTS
    for k in range(_PARTS):
        part = (low + k * width, low + (k + 1) * width)
        middle = 0.5 * (part[0] + part[1])
        other = descend(Meeting(cut, sweep, part, line), h, middle, min(best.mm, limit))
        if other.mm < best.mm:
            best = other
    return best
