"""phi(h, s): how far a line's point is from the tool that stands at one place of its sweep.

Each tool is convex, so phi is convex in h at every s; along a straight sweep it is convex in
(h, s) but for the micrometres of the displacement, whose curvature is bounded by `ripple_of`.

Source: closed form derived here: the distance to a convex body is convex along any line.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from stock.compiled import njit_inlined
from stock.exact.motion import tool_of
from stock.exact.outline import signed_distance
from stock.exact.tool_frame import seen_from_tool

__all__ = ["ToolDistance", "tool_distance"]

#: nearer to the tool's axis there is no direction away from it, mm
_ON_AXIS_MM = 1e-12


class ToolDistance(NamedTuple):
    """A value of phi and its derivatives.

    Attributes
    ----------
    mm : float
        Negative inside the tool.
    by_s, by_ss, by_h : float
        First and second derivative by s, first by h.
    curvature : float
        Of the outline at the nearest point, 1/mm.
    """

    mm: float
    by_s: float
    by_ss: float
    by_h: float
    curvature: float


@njit_inlined()
def tool_distance(meeting, h, s):
    """phi(h, s), a `ToolDistance`.

    Parameters
    ----------
    meeting : Meeting
    h, s : float
        Place on the line, and on the sweep.
    """
    x, x1, x2, d = seen_from_tool(meeting, h, s)
    rho = math.sqrt(x[0] * x[0] + x[1] * x[1])
    tool = tool_of(meeting.cut.motion, meeting.sweep)
    value, gr, gz, curvature = signed_distance(meeting.cut.outlines, tool, rho, x[2])
    scale = 1.0 / max(rho, _ON_AXIS_MM)
    ex, ey = x[0] * scale, x[1] * scale
    radial = ex * x1[0] + ey * x1[1]
    around = ex * x1[1] - ey * x1[0]
    along = gr * x1[2] - gz * radial  # along the outline, square to the gradient
    by_s = gr * radial + gz * x1[2]
    by_ss = curvature * along * along + gr * scale * around * around
    by_ss += gr * (ex * x2[0] + ey * x2[1]) + gz * x2[2]
    by_h = gr * (ex * d[0] + ey * d[1]) + gz * d[2]
    return ToolDistance(value, by_s, by_ss, by_h, curvature)
