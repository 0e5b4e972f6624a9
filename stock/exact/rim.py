"""Where a line goes through a sharp rim of the moving tool.

Right at a rim the gradient of the distance has no limit, so that the last steps have to be made
on the rim's own two equations: radius and height are those of the corner.

Source: closed form derived here: Newton's method on radius and height of the rim, two equations
for h and s.
"""

from __future__ import annotations

import math

from stock.compiled import njit_part
from stock.exact.descent import ROOT_MM
from stock.exact.meeting import TOUCH_MM
from stock.exact.motion import tool_of
from stock.exact.outline import signed_distance
from stock.exact.tool_frame import seen_from_tool

__all__ = ["meet_rim"]

#: a rim is a circle: nearer to the axis than this it is none, mm
_POINTED_MM = 1e-3
_ON_AXIS_MM = 1e-12
_MOST_TURNS = 20


@njit_part()
def meet_rim(meeting, h, s):
    """Solve for the h and s at which the line goes through the rim that it is opposite to.

    Parameters
    ----------
    meeting : Meeting
    h, s : float
        Place on the line, outside the tool, and place of the tool to start from.

    Returns
    -------
    is_met : bool
        Whether there is a sharp rim, met near h on this piece.
    h, s : float
    """
    start = h
    x, x1, _, d = seen_from_tool(meeting, h, s)
    rho = math.sqrt(x[0] * x[0] + x[1] * x[1])
    tool = tool_of(meeting.cut.motion, meeting.sweep)
    distance, gr, gz, curvature = signed_distance(meeting.cut.outlines, tool, rho, x[2])
    if distance <= 0.0 or abs(distance * curvature - 1.0) > 1e-6 or rho < _POINTED_MM:
        return False, h, s  # not opposite a sharp corner
    corner = (rho - gr * distance, x[2] - gz * distance)
    for _ in range(_MOST_TURNS):
        ex, ey = x[0] / rho, x[1] / rho
        off_r, off_z = rho - corner[0], x[2] - corner[1]
        if abs(off_r) + abs(off_z) < ROOT_MM:
            return True, h, s
        r_h, r_s = ex * d[0] + ey * d[1], ex * x1[0] + ey * x1[1]
        det = r_h * x1[2] - r_s * d[2]
        if abs(det) < 1e-12:
            return False, h, s
        h -= (off_r * x1[2] - off_z * r_s) / det
        s -= (r_h * off_z - d[2] * off_r) / det
        is_near = abs(h - start) < 100.0 * distance + TOUCH_MM
        if not (is_near and meeting.span[0] <= s <= meeting.span[1]):
            return False, h, s
        x, x1, _, d = seen_from_tool(meeting, h, s)
        rho = max(math.sqrt(x[0] * x[0] + x[1] * x[1]), _ON_AXIS_MM)
    return False, h, s
