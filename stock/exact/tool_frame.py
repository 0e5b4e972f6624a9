"""A line seen from the tool: the shift is taken off, and the tilt exactly.

The tool's point x stands at tip + x + tilt x x. So x is found by solving this linear equation,
and its derivatives by s by solving the equation's own derivatives.

Source: closed form derived here: (1 + [tilt]x) x = p - tip, solved exactly.
"""

from __future__ import annotations

from stock.compiled import njit_inlined
from stock.exact.meeting import point_at
from stock.exact.motion import tilt_at, tip_at

__all__ = ["seen_from_tool"]


@njit_inlined()
def seen_from_tool(meeting, h, s):
    """The line's point at h in the frame of the tool that stands at s.

    Parameters
    ----------
    meeting : Meeting
    h, s : float

    Returns
    -------
    tuple of 3-tuples of float
        The point from the tip, its first and second derivative by s, its derivative by h; mm.
    """
    motion, n = meeting.cut.motion, meeting.line[1]
    tip, tip1, tip2 = tip_at(motion, meeting.sweep, s)
    x = _minus(point_at(meeting.line, h), tip, 1.0)
    x1, x2 = (-tip1[0], -tip1[1], -tip1[2]), (-tip2[0], -tip2[1], -tip2[2])
    if len(motion.tilt) == 0:
        return x, x1, x2, n
    return _untilted(tilt_at(motion, meeting.sweep, s), (x, x1, x2, n))


@njit_inlined()
def _untilted(tilt, vectors):
    """Take the tilt off: solve x + tilt x x = y for x and its derivatives, and for d."""
    (t, t1, t2), (y, y1, y2, d) = tilt, vectors
    x = _solved(t, y)
    x1 = _solved(t, _minus(y1, _cross(t1, x), 1.0))
    x2 = _solved(t, _minus(_minus(y2, _cross(t2, x), 1.0), _cross(t1, x1), 2.0))
    return x, x1, x2, _solved(t, d)


@njit_inlined()
def _solved(t, y):
    """x with x + t x x = y, that is (y - t x y + t (t.y)) / (1 + t.t)."""
    c = _cross(t, y)
    dot = t[0] * y[0] + t[1] * y[1] + t[2] * y[2]
    scale = 1.0 / (1.0 + t[0] * t[0] + t[1] * t[1] + t[2] * t[2])
    return (
        (y[0] - c[0] + t[0] * dot) * scale,
        (y[1] - c[1] + t[1] * dot) * scale,
        (y[2] - c[2] + t[2] * dot) * scale,
    )


@njit_inlined()
def _cross(a, b):
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@njit_inlined()
def _minus(a, b, k):
    """a - k b."""
    return (a[0] - k * b[0], a[1] - k * b[1], a[2] - k * b[2])
