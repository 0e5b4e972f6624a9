"""Compiled evaluation of B-spline curves and surfaces, and the search for nearest points on them.

Basis functions follow L. Piegl and W. Tiller, The NURBS Book, 2nd ed. 1997, algorithms A2.1 and
A2.2; their derivatives eq. (2.7). All control points are homogeneous: x w, y w, z w, w.

Source: L. Piegl and W. Tiller, The NURBS Book (1997), algorithms A2.1 and A2.2, eq. 2.7.
"""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = [
    "LARGEST_DEGREE",
    "evaluate_curve",
    "evaluate_surface",
    "nearest_on_curve",
    "nearest_parameters",
]

#: the room that basis functions are given
LARGEST_DEGREE = 31

_MOST_STEPS = 30

#: a step smaller than this, relative to the range of the parameters, ends the search
_SMALL_STEP = 1e-14

#: a touch of damping keeps the step finite at poles
_DAMPING = 1e-14


@njit(cache=True, nogil=True)
def _span(knots, degree, t):
    """Index of the knot span that holds t, the last one at the end of the knots."""
    low, high = degree, len(knots) - degree - 1
    if t >= knots[high]:
        low = high - 1
        while low > degree and knots[low] == knots[high]:
            low -= 1
        return low
    while high - low > 1:
        middle = (low + high) // 2
        if t < knots[middle]:
            high = middle
        else:
            low = middle
    return low


@njit(cache=True, nogil=True)
def _basis(knots, degree, t, values, slopes):
    """Fill in the basis functions that are not zero at t and their slopes; return the span."""
    span = _span(knots, degree, t)
    values[0] = 1.0
    slopes[0] = 0.0
    for k in range(1, degree + 1):
        if k == degree:
            for r in range(degree + 1):
                slopes[r] = 0.0
            for r in range(degree):
                width = knots[span + r + 1] - knots[span + r + 1 - degree]
                share = degree * values[r] / width if width > 0.0 else 0.0
                slopes[r] -= share
                slopes[r + 1] += share
        carried = 0.0
        for r in range(k):
            right, left = knots[span + r + 1] - t, t - knots[span + r + 1 - k]
            width = right + left
            share = values[r] / width if width > 0.0 else 0.0
            values[r] = carried + right * share
            carried = left * share
        values[k] = carried
    return span


@njit(cache=True, nogil=True)
def _curve_at(knots, control, place, room, out):
    """Fill in the point and the slope, (2, 3), of one place; `room` is (2, degree + 1)."""
    degree = room.shape[1] - 1
    span = _basis(knots, degree, place, room[0], room[1])
    weight = change = 0.0
    out[:] = 0.0
    for i in range(degree + 1):
        c = control[span - degree + i]
        weight += room[0, i] * c[3]
        change += room[1, i] * c[3]
        for axis in range(3):
            out[0, axis] += room[0, i] * c[axis]
            out[1, axis] += room[1, i] * c[axis]
    for axis in range(3):
        out[0, axis] /= weight
        out[1, axis] = (out[1, axis] - change * out[0, axis]) / weight


@njit(cache=True, nogil=True)
def evaluate_curve(knots, degree, control, t):
    """Points and slopes of a curve at parameters (N,) inside the range; (N, 2, 3) float64.

    Parameters are knots (n + k + 1,), the degree k, and control points (n, 4).
    """
    out, room = np.empty((len(t), 2, 3)), np.empty((2, degree + 1))
    for n in range(len(t)):
        _curve_at(knots, control, t[n], room, out[n])
    return out


@njit(cache=True, nogil=True)
def nearest_on_curve(knots, degree, control, seeds, seeds_mm, points, period):
    """Parameters of the nearest points, (N,), by Gauss-Newton steps from the nearest seeds.

    Seeds are parameters (S,) and their points (S, 3). `period` is 0 where the curve is not closed:
    there parameters stay inside the range.
    """
    low, high = knots[degree], knots[-degree - 1]
    small = _SMALL_STEP * (high - low)
    here, room, t = np.empty((2, 3)), np.empty((2, degree + 1)), np.empty(len(points))
    for n in range(len(points)):
        t[n] = seeds[_nearest(seeds_mm, points[n])]
        for _ in range(_MOST_STEPS):
            place = low + (t[n] - low) % period if period > 0.0 else t[n]
            _curve_at(knots, control, place, room, here)
            square = to = 0.0
            for axis in range(3):
                square += here[1, axis] * here[1, axis]
                to += (points[n, axis] - here[0, axis]) * here[1, axis]
            step = to / max(square, 1e-300)
            t[n] = t[n] + step if period > 0.0 else min(max(t[n] + step, low), high)
            if abs(step) < small:
                break
    return t


@njit(cache=True, nogil=True)
def _nearest(places, point):
    """Index of the nearest of some places (S, 3) to a point."""
    found, least = 0, np.inf
    for s in range(len(places)):
        square = 0.0
        for axis in range(3):
            square += (places[s, axis] - point[axis]) ** 2
        if square < least:
            found, least = s, square
    return found


@njit(cache=True, nogil=True)
def _at(knots_u, knots_v, degrees, control, place, room, out):
    """Fill in the point and the slopes along u and v, (3, 3), of one place; `room` is (4, k)."""
    ku, kv = degrees
    span_u = _basis(knots_u, ku, place[0], room[0], room[1])
    span_v = _basis(knots_v, kv, place[1], room[2], room[3])
    sums = np.zeros((3, 4))
    for i in range(ku + 1):
        for j in range(kv + 1):
            value = room[0, i] * room[2, j]
            along_u, along_v = room[1, i] * room[2, j], room[0, i] * room[3, j]
            for axis in range(4):
                c = control[span_u - ku + i, span_v - kv + j, axis]
                sums[0, axis] += value * c
                sums[1, axis] += along_u * c
                sums[2, axis] += along_v * c
    weight = sums[0, 3]
    for axis in range(3):
        out[0, axis] = sums[0, axis] / weight
        out[1, axis] = (sums[1, axis] - sums[1, 3] * out[0, axis]) / weight
        out[2, axis] = (sums[2, axis] - sums[2, 3] * out[0, axis]) / weight


@njit(cache=True, nogil=True)
def evaluate_surface(knots_u, knots_v, degrees, control, uv):
    """Points and slopes along u and v at parameters inside the range.

    Parameters
    ----------
    knots_u, knots_v : (n + k + 1,) float64
    degrees : (int, int)
        At most `LARGEST_DEGREE`.
    control : (n, m, 4) float64
    uv : (N, 2) float64

    Returns
    -------
    (N, 3, 3) float64
        Point, dS/du and dS/dv of each.
    """
    out, room = np.empty((len(uv), 3, 3)), np.empty((4, LARGEST_DEGREE + 1))
    for n in range(len(uv)):
        _at(knots_u, knots_v, degrees, control, uv[n], room, out[n])
    return out


@njit(cache=True, nogil=True)
def nearest_parameters(knots_u, knots_v, degrees, control, start_uv, points, period):
    """Parameters of the nearest points, (N, 2), by Gauss-Newton steps from `start_uv` (N, 2).

    `period` is 0 where the surface is not closed: there parameters stay inside the range.
    """
    low = np.array([knots_u[degrees[0]], knots_v[degrees[1]]])
    high = np.array([knots_u[-degrees[0] - 1], knots_v[-degrees[1] - 1]])
    small = _SMALL_STEP * max(high[0] - low[0], high[1] - low[1])
    here, room = np.empty((3, 3)), np.empty((4, LARGEST_DEGREE + 1))
    uv, step = start_uv.copy(), np.empty(2)
    for n in range(len(points)):
        for _ in range(_MOST_STEPS):
            _at(knots_u, knots_v, degrees, control, uv[n], room, here)
            _step(here, points[n], step)
            for axis in range(2):
                t = uv[n, axis] + step[axis]
                if period[axis] > 0.0:
                    t = low[axis] + (t - low[axis]) % period[axis]
                uv[n, axis] = min(max(t, low[axis]), high[axis])
            if max(abs(step[0]), abs(step[1])) < small:
                break
    return uv


@njit(cache=True, nogil=True)
def _step(here, point, step):
    """Fill in the Gauss-Newton step in u and v towards a point."""
    uu = uv = vv = to_u = to_v = 0.0
    for axis in range(3):
        gap, along_u, along_v = point[axis] - here[0, axis], here[1, axis], here[2, axis]
        uu += along_u * along_u
        uv += along_u * along_v
        vv += along_v * along_v
        to_u += along_u * gap
        to_v += along_v * gap
    damping = _DAMPING * (uu + vv) + 1e-300
    uu, vv = uu + damping, vv + damping
    determinant = uu * vv - uv * uv
    if determinant > 0.0:
        step[0] = (vv * to_u - uv * to_v) / determinant
        step[1] = (uu * to_v - uv * to_u) / determinant
    else:
        step[0] = step[1] = 0.0
