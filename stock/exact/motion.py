"""Motion of the displaced tool along each sweep, with two derivatives, for the kernels.

A line with its shift is one cubic in s; an arc adds its circle to the cubic of the shift. The
tilt is a cubic of its own and is left out where every tilt is zero.

Source: closed form derived here: a line with its shift is one cubic, an arc adds its circle;
derivatives term by term.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from stock.compiled import njit_inlined, njit_kernel
from stock.errors import StockError
from stock.sweeps import Sweeps
from stock.threads import run_in_parts

__all__ = [
    "Motion",
    "arc_of",
    "bend_of",
    "bend_of_height",
    "build_motion",
    "on_arcs",
    "ripple_of",
    "tilt_at",
    "tip_at",
    "tip_positions",
    "tool_of",
    "tools_of",
]

#: rows whose intermediate values are held at a time
_ROWS_AT_ONCE = 65_536
#: an arc has to end where its angle says within this, mm: above the rounding of any program
_ARC_END_MM = 1e-6


#: columns of `Motion.path`: a bound, mm, on the second derivative by s of a tool point's way
#: that the displacement causes, so how far the sweep can be from convex; ...
_RIPPLE = 12
#: ... the same with the arc's own curvature; row in `Motion.arcs` or -1; index of the tool
_BEND, _ARC, _TOOL = 13, 14, 15


class Motion(NamedTuple):
    """Polynomials and circles of all sweeps.

    Attributes
    ----------
    path : (M, 16) float64
        What is looked up of a sweep, side by side: coefficients (4, 3) by power of s of the
        line plus shift, or of the shift alone on an arc; then the columns RIPPLE to TOOL.
    tilt : (M, 12) or (0, 12) float64
        Coefficients (4, 3) of the tilt.
    arcs : (A, 5, 3) float64
        Centre; unit radius at the start; axis x that; rise along the axis; and start radius,
        its growth, angle.
    """

    path: np.ndarray
    tilt: np.ndarray
    arcs: np.ndarray


def build_motion(parts: Iterable[Sweeps], count: int, reach_of_tool_mm: np.ndarray) -> Motion:
    """Bring sweeps into the kernels' form.

    Parameters
    ----------
    parts : iterable of Sweeps
        One after the other; each may be forgotten when the next is asked for.
    count : int
        How many sweeps all parts have.
    reach_of_tool_mm : (T,) float64
        Distance from the tip to the farthest point of each tool.

    Raises
    ------
    StockError
        If an arc does not end where its angle says.
    """
    path, tilt, arcs = np.empty((count, 16)), np.empty((0, 12)), [np.empty((0, 5, 3))]
    done = arc_count = 0
    for sweeps in parts:
        rows = slice(done, done + len(sweeps))
        _write_path(path[rows], sweeps)
        if sweeps.tilt_rad.any() or sweeps.tilt_slope_rad.any():
            tilt = tilt if len(tilt) else np.zeros((count, 12))
            for begin in range(0, len(sweeps), _ROWS_AT_ONCE):
                some = slice(begin, begin + _ROWS_AT_ONCE)
                _add_tilt(path[rows], tilt[rows], sweeps, some, reach_of_tool_mm)
        curved = np.flatnonzero(sweeps.sweep_rad != 0.0)
        arcs.append(_arcs(sweeps, curved, done))
        radius, growth, angle = arcs[-1][:, 4].T
        own = (radius + np.maximum(growth, 0.0)) * angle**2 + 2.0 * np.abs(growth * angle)
        path[done + curved, _BEND] += own
        path[done + curved, _ARC] = arc_count + np.arange(len(curved))
        done, arc_count = rows.stop, arc_count + len(curved)
    return Motion(path, tilt, np.concatenate(arcs))


def on_arcs(motion: Motion) -> np.ndarray:
    """Which sweeps are arcs, (M,) bool."""
    return motion.path[:, _ARC] >= 0.0


def tools_of(motion: Motion) -> np.ndarray:
    """Index of the tool of every sweep, (M,) int32."""
    return motion.path[:, _TOOL].astype(np.int32)


def _write_path(path: np.ndarray, sweeps: Sweeps) -> None:
    """Rows of `Motion.path` without what tilts and arcs add."""
    straight = sweeps.sweep_rad == 0.0
    shift, ends = (sweeps.shift_mm, sweeps.shift_slope_mm), (sweeps.start_mm, sweeps.end_mm)
    run_in_parts(
        lambda begin, end: _fill_path(path, shift, ends, (straight, sweeps.tool), (begin, end)),
        len(path),
    )


def _add_tilt(
    path: np.ndarray, tilt: np.ndarray, sweeps: Sweeps, rows: slice, reach_of_tool_mm: np.ndarray
) -> None:
    """Write some rows of `Motion.tilt`, and what the tilt adds to the bounds of `Motion.path`."""
    ripple = np.empty(len(tilt[rows]))
    _fill_tilt(tilt[rows], ripple, sweeps.tilt_rad[rows], sweeps.tilt_slope_rad[rows])
    arm = reach_of_tool_mm[sweeps.tool[rows]]
    speed = np.linalg.norm(sweeps.end_mm[rows] - sweeps.start_mm[rows], axis=1)
    slope = np.linalg.norm(tilt[rows].reshape(-1, 4, 3)[:, 1:], axis=2) @ np.array([1.0, 2.0, 3.0])
    path[rows, _RIPPLE] += arm * ripple + 2.0 * slope * speed
    path[rows, _BEND] = path[rows, _RIPPLE]


@njit_kernel()
def _fill_path(path, shift, ends, kind, part):
    """Write rows of `Motion.path`, arcs without their own curvature and number."""
    (start, end), (straight, tool) = ends, kind
    for i in range(part[0], part[1]):
        _hermite(shift[0], shift[1], i, path)
        path[i, _RIPPLE] = path[i, _BEND] = _largest_second_derivative(path, i)
        path[i, _ARC], path[i, _TOOL] = -1.0, tool[i]
        if straight[i]:
            for j in range(3):
                path[i, j] += start[i, j]
                path[i, 3 + j] += end[i, j] - start[i, j]


@njit_kernel()
def _fill_tilt(tilt, bend, value, slope):
    """Write the tilts' cubics and how much they bend at most."""
    for i in range(len(tilt)):
        _hermite(value, slope, i, tilt)
        bend[i] = _largest_second_derivative(tilt, i)


@njit_inlined()
def _hermite(value, slope, i, cubic):
    """Write the power coefficients of the cubic i with these end values and end slopes."""
    for j in range(3):
        rise = value[i, 1, j] - value[i, 0, j]
        cubic[i, j] = value[i, 0, j]
        cubic[i, 3 + j] = slope[i, 0, j]
        cubic[i, 6 + j] = 3.0 * rise - 2.0 * slope[i, 0, j] - slope[i, 1, j]
        cubic[i, 9 + j] = slope[i, 0, j] + slope[i, 1, j] - 2.0 * rise


@njit_inlined()
def _largest_second_derivative(cubic, i):
    """Largest norm of the second derivative over s in [0, 1]: it is linear, so at an end."""
    start, end = 0.0, 0.0
    for j in range(6, 9):
        start += (2.0 * cubic[i, j]) ** 2
        end += (2.0 * cubic[i, j] + 6.0 * cubic[i, 3 + j]) ** 2
    return math.sqrt(max(start, end))


def _arcs(sweeps: Sweeps, which: np.ndarray, first: int) -> np.ndarray:
    """Rows of `Motion.arcs` for the sweeps `which`, checked; `first` is the number of sweep 0."""
    axis, angle = sweeps.axis[which], sweeps.sweep_rad[which]
    start, end, centre = sweeps.start_mm[which], sweeps.end_mm[which], sweeps.centre_mm[which]
    if len(which) and np.abs(np.linalg.norm(axis, axis=1) - 1.0).max() > 1e-9:
        bad = which[np.argmax(np.abs(np.linalg.norm(axis, axis=1) - 1.0))]
        raise StockError(
            f"axis of the arc in sweep {first + bad} is no unit vector: {sweeps.axis[bad]}"
        )
    centre = centre + axis * _dot(start - centre, axis)
    rise = axis * _dot(end - start, axis)
    radial_start, radial_end = start - centre, end - rise - centre
    start_radius = np.linalg.norm(radial_start, axis=1)
    end_radius = np.linalg.norm(radial_end, axis=1)
    growth = end_radius - start_radius
    back = _turned(radial_end, axis, -angle)
    longer = np.where((start_radius >= end_radius)[:, None], radial_start, back)
    length = np.linalg.norm(longer, axis=1, keepdims=True)
    unit = np.divide(longer, length, out=np.zeros_like(longer), where=length > 0.0)
    gap = np.linalg.norm(_turned(unit, axis, angle) * end_radius[:, None] - radial_end, axis=1)
    if len(which) and gap.max() > _ARC_END_MM:
        bad = np.argmax(gap)
        raise StockError(
            f"arc in sweep {first + which[bad]} (move {sweeps.move[which[bad]]}) misses its end by "
            f"{gap[bad]:.3g} mm",
            accepted="end_mm at the angle sweep_rad from start_mm about axis through centre_mm",
        )
    sizes = np.stack([start_radius, growth, angle], axis=1)
    return np.stack([centre, unit, np.cross(axis, unit), rise, sizes], axis=1)


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.einsum("ij,ij->i", a, b)[:, None]


def _turned(vector: np.ndarray, axis: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """`vector`, square to `axis`, turned about it."""
    angle = angle[:, None]
    return vector * np.cos(angle) + np.cross(axis, vector) * np.sin(angle)


@njit_inlined()
def ripple_of(motion, i):
    """Bound on how far sweep `i` is from convex: see `Motion.path`, mm."""
    return motion.path[i, _RIPPLE]


@njit_inlined()
def bend_of(motion, i):
    """Bound on the second derivative by s of any tool point's way on sweep `i`, mm."""
    return motion.path[i, _BEND]


@njit_inlined()
def bend_of_height(motion, i, tilt):
    """Bound on the second derivative by s of a height above sweep `i`'s tool, mm.

    About an upright axis the circle itself changes no height but by the tool's `tilt`, rad.
    """
    a, k = motion.arcs, arc_of(motion, i)
    own = bend_of(motion, i) - ripple_of(motion, i)
    is_upright = k < 0 or (a[k, 1, 2] == 0.0 and a[k, 2, 2] == 0.0)
    return ripple_of(motion, i) + (tilt * own if is_upright else own)


@njit_inlined()
def arc_of(motion, i):
    """Row of sweep `i` in `Motion.arcs`, -1 where it is straight."""
    return int(motion.path[i, _ARC])


@njit_inlined()
def tool_of(motion, i):
    """Index of the tool of sweep `i`."""
    return int(motion.path[i, _TOOL])


@njit_inlined()
def _cubic(a, i, j, s):
    """Value and two derivatives of component j of polynomial i."""
    c1, c2, c3 = a[i, 3 + j], a[i, 6 + j], a[i, 9 + j]
    value = a[i, j] + s * (c1 + s * (c2 + s * c3))
    return value, c1 + s * (2.0 * c2 + s * (3.0 * c3)), 2.0 * c2 + 6.0 * s * c3


@njit_inlined()
def _cubics(a, i, s):
    x, x1, x2 = _cubic(a, i, 0, s)
    y, y1, y2 = _cubic(a, i, 1, s)
    z, z1, z2 = _cubic(a, i, 2, s)
    return (x, y, z), (x1, y1, z1), (x2, y2, z2)


@njit_inlined()
def _on_arc(a, k, along, across):
    return (
        along * a[k, 1, 0] + across * a[k, 2, 0],
        along * a[k, 1, 1] + across * a[k, 2, 1],
        along * a[k, 1, 2] + across * a[k, 2, 2],
    )


@njit_inlined()
def _sum(u, v, w):
    return (u[0] + v[0] + w[0], u[1] + v[1] + w[1], u[2] + v[2] + w[2])


@njit_inlined()
def tip_at(motion, i, s):
    """Position of the displaced tip of sweep `i` at `s`, and its two derivatives by s, mm."""
    place, first, second = _cubics(motion.path, i, s)
    a, k = motion.arcs, arc_of(motion, i)
    if k < 0:
        return place, first, second
    growth, turn = a[k, 4, 1], a[k, 4, 2]
    radius, c, d = a[k, 4, 0] + growth * s, math.cos(turn * s), math.sin(turn * s)
    # the circle's point is along * unit radius + across * (axis x unit radius)
    along, across = radius * c, radius * d
    along1, across1 = growth * c - turn * across, growth * d + turn * along
    along2 = -turn * (turn * along + 2.0 * growth * d)
    across2 = turn * (2.0 * growth * c - turn * across)
    rise = (a[k, 3, 0], a[k, 3, 1], a[k, 3, 2])
    centre = (a[k, 0, 0] + s * rise[0], a[k, 0, 1] + s * rise[1], a[k, 0, 2] + s * rise[2])
    return (
        _sum(place, centre, _on_arc(a, k, along, across)),
        _sum(first, rise, _on_arc(a, k, along1, across1)),
        _sum(second, (0.0, 0.0, 0.0), _on_arc(a, k, along2, across2)),
    )


@njit_inlined()
def tilt_at(motion, i, s):
    """Tilt of sweep `i` at `s` and its two derivatives by s, rad."""
    return _cubics(motion.tilt, i, s)


def tip_positions(motion, sweep, s):
    """Positions (K, 3) of the displaced tip of the sweeps (K,) at s (K,), mm."""
    place = np.empty((len(sweep), 3))
    _fill_positions(place, motion, sweep, s)
    return place


@njit_kernel()
def _fill_positions(place, motion, sweep, s):
    for k in range(len(sweep)):
        place[k, 0], place[k, 1], place[k, 2] = tip_at(motion, sweep[k], s[k])[0]
