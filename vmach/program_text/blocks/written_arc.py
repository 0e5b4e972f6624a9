"""Arcs whose end and centre are rounded: the centre or radius that keeps them best.

Compiled code, for arcs that are written one by one and for runs of them. An arc is five points of
its plane, (5, 2) in program units: where it shall begin, its middle, its end; and where the tool
really is before it and after it.

Source: closed form derived here: distance of one circle from another at places along it.
"""

from __future__ import annotations

import math

import numpy as np

from stock.compiled import njit_inlined, njit_kernel, njit_part
from vmach.program_text.blocks.circles import circle_centre, length, swept

__all__ = ["CENTRE", "LINE", "RADIUS", "fit_arc"]

#: how an arc is written: as a line, by its centre, by its radius
LINE, CENTRE, RADIUS = 0, 1, 2
_BEGIN, _MIDDLE, _END, _START, _STOP = range(5)
#: rounded centres that are tried, steps from the nearest in each axis
_TRIES = 2
#: places along an arc at which it is compared with the wanted one
_SHARES = (0.25, 0.5, 0.75)
#: an arc that is written turns by no more, and by about as much as the wanted one
_LARGEST_SWEEP_RAD = math.radians(190.0)
_SWEEP_SLACK_RAD = 0.3
#: with R, arcs this near to a half circle have no certain centre
_UNCERTAIN_RAD = math.radians(170.0)
#: the radius is taken where it misses by no more than this share of a step, or than the centre
_RADIUS_STEPS = 0.3


@njit_kernel()
def fit_arc(arc, origin, step, tolerance, by_radius):
    """The rounded centre or radius whose arc is nearest to the wanted one.

    Parameters
    ----------
    arc : (5, 2) float64
    origin : (2,) float64
        Where the words of the centre count from.
    step : float
        Resolution of the words.
    tolerance : (3,) float64
        Absolute, and relative to the larger one, by which radii at start and end may differ; and
        the least radius that a control takes for an arc.
    by_radius : bool
        The block has a radius.

    Returns
    -------
    tuple
        `LINE`, `CENTRE` or `RADIUS`; whether it turns counter-clockwise, from the first over the
        second axis; the numbers of the centre's words, or the radius and zero.
    """
    a, b, c = arc[_BEGIN], arc[_MIDDLE], arc[_END]
    sense = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) > 0.0
    found, x, y = circle_centre(a, b, c)
    if not found:
        return LINE, sense, 0.0, 0.0
    miss, i, j = _best_centre(arc, (x, y), sense, origin, step, tolerance)
    if not miss < _chord_miss(arc):
        return LINE, sense, 0.0, 0.0
    if by_radius:
        off, radius = _best_radius(arc, (x, y), sense, step)
        if off <= max(miss, _RADIUS_STEPS * step):
            return RADIUS, sense, radius, 0.0
    return CENTRE, sense, i, j


@njit_inlined()
def _best_centre(arc, centre, sense, origin, step, tolerance):
    """Distance of the best arc, infinite for none, and the words of its centre.

    Of equals the first counts. The nearest centre is asked first: it tells how good the others
    have to be.
    """
    side = 2 * _TRIES + 1
    near_i = np.rint((centre[0] - origin[0]) / step) * step
    near_j = np.rint((centre[1] - origin[1]) / step) * step
    best, least, found = -1, np.inf, np.inf
    for turn in range(-1, side * side):
        k = turn if turn >= 0 else side * side // 2
        x = origin[0] + (near_i + step * (k // side - _TRIES))
        y = origin[1] + (near_j + step * (k % side - _TRIES))
        first = length(arc[_START, 0] - x, arc[_START, 1] - y)
        last = length(arc[_STOP, 0] - x, arc[_STOP, 1] - y)
        if min(first, last) < tolerance[2]:  # of an arc of a micrometre between two steps
            continue
        # controls differ in what they do with unlike radii: half their difference counts as well
        unlike = abs(first - last)
        if unlike > max(tolerance[0], tolerance[1] * max(first, last)) or 0.5 * unlike > least:
            continue
        miss = _miss(arc, centre, sense, x, y, least)
        badness = max(miss, 0.5 * unlike)
        if badness < least or (badness == least and k < best):
            best, least, found = k, badness, miss
    if best < 0:
        return np.inf, 0.0, 0.0
    return found, near_i + step * (best // side - _TRIES), near_j + step * (best % side - _TRIES)


@njit_inlined()
def _best_radius(arc, centre, sense, step):
    """Distance of the best arc by radius, infinite where none is certain, and the radius."""
    best, radius = np.inf, 0.0
    if swept(centre[0], centre[1], arc[_START], arc[_END], sense) > _UNCERTAIN_RAD:
        return best, radius
    wanted = length(arc[_BEGIN, 0] - centre[0], arc[_BEGIN, 1] - centre[1])
    near = np.rint(wanted / step) * step
    for value in (near, near - step, near + step):
        found, x, y = _centre_of_radius(arc, value, sense)
        miss = _miss(arc, centre, sense, x, y, best) if found else np.inf
        if miss < best:
            best, radius = miss, value
    return best, radius


@njit_inlined()
def _chord_miss(arc):
    """Distance of the wanted middle from the straight line to the written end."""
    along_x, along_y = arc[_STOP, 0] - arc[_START, 0], arc[_STOP, 1] - arc[_START, 1]
    out_x, out_y = arc[_MIDDLE, 0] - arc[_START, 0], arc[_MIDDLE, 1] - arc[_START, 1]
    chord = length(along_x, along_y)
    if chord == 0.0:
        return length(out_x, out_y)
    return abs(along_x * out_y - along_y * out_x) / chord


@njit_part()
def _miss(arc, centre, sense, x, y, most):
    """Largest distance of the arc about a place from the circle about `centre`.

    Infinite where the arc turns otherwise; some distance above `most` where it is larger than that.
    """
    sweep = swept(x, y, arc[_START], arc[_STOP], sense)
    wanted = swept(centre[0], centre[1], arc[_START], arc[_END], sense)
    if sweep > _LARGEST_SWEEP_RAD or abs(sweep - wanted) > _SWEEP_SLACK_RAD:
        return np.inf
    radius = length(arc[_BEGIN, 0] - centre[0], arc[_BEGIN, 1] - centre[1])
    out_x, out_y = arc[_START, 0] - x, arc[_START, 1] - y
    first, last = length(out_x, out_y), length(arc[_STOP, 0] - x, arc[_STOP, 1] - y)
    begin, turn, worst = math.atan2(out_y, out_x), sweep if sense else -sweep, 0.0
    for share in _SHARES:
        angle, here = begin + share * turn, first + share * (last - first)
        off_x = x + here * math.cos(angle) - centre[0]
        off_y = y + here * math.sin(angle) - centre[1]
        worst = max(worst, abs(length(off_x, off_y) - radius))
        if worst > most:
            break
    return worst


@njit_inlined()
def _centre_of_radius(arc, radius, sense):
    """Centre of the shorter arc of this radius, as a control finds it, and whether there is one."""
    x, y = arc[_STOP, 0] - arc[_START, 0], arc[_STOP, 1] - arc[_START, 1]
    half = 0.5 * length(x, y)
    if half == 0.0 or half >= radius:
        return False, 0.0, 0.0
    away = math.sqrt(radius * radius - half * half) / (2.0 * half) * (1.0 if sense else -1.0)
    return True, arc[_START, 0] + 0.5 * x - away * y, arc[_START, 1] + 0.5 * y + away * x
