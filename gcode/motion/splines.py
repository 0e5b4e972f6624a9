"""G5, G5.1, G5.2-G5.3: cubic and quadratic splines and NURBS in the XY plane, as short lines.

Source: LinuxCNC, G-Codes: G5 to G5.3; L. Piegl and W. Tiller, The NURBS Book (1997).
"""

from __future__ import annotations

import math

import numpy as np

from gcode.errors import ProgramError
from gcode.motion.feed import check_feed, set_inverse_time_feed
from gcode.motion.interpolation import block_end, traverse
from gcode.state.block_values import Values
from gcode.state.controller import XY, Controller
from gcode.state.record import Call

__all__ = ["close_nurbs", "nurbs_point", "spline"]

#: How far the lines may be from the curve, mm.
_CHORD_MM = 1e-4
#: Points per control point that the stand-alone interpreter shows.
_PREVIEW_POINTS = 15


def nurbs_points(control: np.ndarray, weights: np.ndarray, order: int, u: np.ndarray) -> np.ndarray:
    """Points of a clamped uniform NURBS curve, (U, 2).

    Parameters
    ----------
    control : (C, 2) float64
        Control points.
    weights : (C,) float64
        Their weights.
    order : int
        Degree plus one.
    u : (U,) float64
        Parameter from 0 to C - order + 1.
    """
    last = len(control) - order + 1
    knots = np.concatenate((np.zeros(order - 1), np.arange(last + 1), np.full(order - 1, last)))
    span = np.minimum(np.floor(u).astype(int), last - 1) + order - 1
    points = np.column_stack((control * weights[:, None], weights))
    work = points[span[:, None] + np.arange(-order + 1, 1)]  # (U, order, 3)
    for level in range(1, order):
        for j in range(order - 1, level - 1, -1):
            left = knots[span - order + 1 + j]
            right = knots[span + 1 + j - level]
            share = ((u - left) / (right - left))[:, None]
            work[:, j] = (1.0 - share) * work[:, j - 1] + share * work[:, j]
    return work[:, -1, :2] / work[:, -1, 2:]


def _emit(controller: Controller, control: list[tuple[float, float, float]], order: int) -> None:
    """Follow the curve with straight moves."""
    table = np.array(control)
    if controller.preview:
        points = _preview_points(table, order)
    else:
        points = _fine_points(table, order, _CHORD_MM / controller.unit_mm)
    for x, y in [*points.tolist(), table[-1, :2].tolist()]:
        traverse(controller, [x, y, *controller.position[2:]], Call.FEED)


def _fine_points(table: np.ndarray, order: int, chord: float) -> np.ndarray:
    """Points between the ends, so many that straight lines stay within `chord` of the curve."""
    last, count = len(table) - order + 1, 8 * len(table)
    points = nurbs_points(table[:, :2], table[:, 2], order, np.linspace(0.0, last, count + 1))
    sag = np.inf
    while sag > chord and count < 1 << 16:
        count *= 2
        u = np.linspace(0.0, last, count + 1)
        finer = nurbs_points(table[:, :2], table[:, 2], order, u)
        sag = 0.25 * np.abs(finer[1::2] - 0.5 * (points[1:] + points[:-1])).max()
        points = finer
    return points[1:-1]


def _preview_points(table: np.ndarray, order: int) -> np.ndarray:
    """Points between the ends as the stand-alone interpreter steps through the parameter."""
    last, count = len(table) - order + 1, _PREVIEW_POINTS * len(table)
    u = np.cumsum(np.full(count + 1, last / count))
    return nurbs_points(table[:, :2], table[:, 2], order, u[u < last])


def spline(controller: Controller, block: Values, motion: int) -> None:
    """G5 (cubic) and G5.1 (quadratic)."""
    controller.require_no_compensation("use splines")
    check_feed(controller, block, "spline")
    words = block.words
    if controller.plane != XY or {"z", "a", "b", "c"} & words.keys():
        raise ProgramError("splines move X and Y in G17 only")
    end = block_end(controller, block)
    x, y = controller.position[:2]
    if ("i" in words) != ("j" in words) or (motion == "G5.1" and "i" not in words):
        raise ProgramError("spline with one of I and J", accepted="both")
    if motion == "G5.1":
        control = [(x, y, 1.0), (x + words["i"], y + words["j"], 1.0), (end[0], end[1], 1.0)]
    else:
        if not {"p", "q"} <= words.keys():
            raise ProgramError("G5 without P and Q")
        i, j = (words["i"], words["j"]) if "i" in words else controller.cycle.ijk[:2]
        third = (end[0] + words["p"], end[1] + words["q"], 1.0)
        control = [(x, y, 1.0), (x + i, y + j, 1.0), third, (end[0], end[1], 1.0)]
        controller.cycle.ijk = (-words["p"], -words["q"], controller.cycle.ijk[2])
    chord = math.hypot(end[0] - x, end[1] - y)
    set_inverse_time_feed(controller, block, chord)
    _emit(controller, control, len(control))


def nurbs_point(controller: Controller, block: Values) -> None:
    """G5.2: one more control point."""
    words, points = block.words, controller.control_points
    check_feed(controller, block, "G5.2")
    controller.require_no_compensation("use NURBS")
    if controller.plane != XY:
        raise ProgramError("NURBS outside G17")
    if controller.motion != "G5.2":
        points.clear()
    if ("x" in words) != ("y" in words):
        raise ProgramError("G5.2 with one of X and Y", accepted="both")
    weight = words.get("p", -1.0)
    if points and (weight <= 0.0 or "x" not in words):
        given = f"P{weight:g}" if "p" in words else "no P"
        raise ProgramError(f"G5.2 with {given}", accepted="X, Y and a positive weight P")
    if not points:
        first = weight if weight > 0.0 and "x" not in words else 1.0
        points.append((controller.position[0], controller.position[1], first))
        controller.nurbs_order = 3
    if words.get("l", 0.0) > 3:
        controller.nurbs_order = int(words["l"])
    if "x" in words:
        if weight <= 0.0:
            given = f"P{weight:g}" if "p" in words else "no P"
            raise ProgramError(f"G5.2 with {given}", accepted="a positive weight P")
        end = block_end(controller, block)
        points.append((end[0], end[1], weight))
    controller.motion = "G5.2"


def close_nurbs(controller: Controller) -> None:
    """G5.3: run the NURBS curve through the collected control points."""
    points, order = controller.control_points, controller.nurbs_order
    if controller.motion != "G5.2":
        raise ProgramError("G5.3 without G5.2")
    if len(points) < order:
        raise ProgramError(
            f"NURBS of order {order} with {len(points)} control points",
            accepted=f"at least {order}",
        )
    controller.motion = None
    _emit(controller, list(points), order)
    points.clear()
