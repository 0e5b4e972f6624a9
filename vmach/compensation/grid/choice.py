"""The sequence of grid points that leaves least at the probes, by dynamic programming.

Source: R. Bellman, Dynamic Programming (1957).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

__all__ = ["Course", "Points", "advance", "best_points", "best_sequence", "traced_back"]


class Course(NamedTuple):
    """K pieces and their P probes in order of the path. Lengths are in steps of the grid.

    ``base + normal . place`` is left at a probe, where the place goes linearly from that of the
    piece's start to that of its end.

    Attributes
    ----------
    normal : (P, 3) float64
        In the frame of the piece.
    base, weight, parameter : (P,) float64
    only_below : (P,) bool
        Positive deviations do not count.
    begin : (K,) int64
        First probe of every piece that begins where its move does; -1 for other pieces.
    start : (K,) float64
        Parameter there.
    stays : (K,) float64
        Weight of the whole distance of every end.
    still : (K, 3) float64
        Weight against motion of the axes in every piece.
    large : float
        How much large deviations count: x ** 2 + large * x ** 8.
    """

    normal: np.ndarray
    base: np.ndarray
    weight: np.ndarray
    parameter: np.ndarray
    only_below: np.ndarray
    begin: np.ndarray
    start: np.ndarray
    stays: np.ndarray
    still: np.ndarray
    large: float


class Points(NamedTuple):
    """C points for each of E ends.

    Attributes
    ----------
    parameter : (E, C) float64
    bound : (E, C) int64
        First probe beyond the end.
    at_end, at_start : (E, C, 3) float64
        Place in the frame of the piece that ends there, and of the next one.
    off, corrected : (E, C, 3) float64
        Distance from the wanted path and from the nominal one, machine axes.
    """

    parameter: np.ndarray
    bound: np.ndarray
    at_end: np.ndarray
    at_start: np.ndarray
    off: np.ndarray
    corrected: np.ndarray


@njit(cache=True)
def _left(course, k, one, a, i, two, b, j):
    """Cost of piece k from point i of end a of `one` to point j of end b of `two`."""
    first, p0 = course.begin[k], course.start[k]
    if first < 0:
        first, p0 = one.bound[a, i], one.parameter[a, i]
    last, p1 = two.bound[b, j], two.parameter[b, j]
    start, end = one.at_start[a, i], two.at_end[b, j]
    per_span = 1.0 / (p1 - p0) if p1 > p0 else 0.0
    cost = 0.0
    for probe in range(first, last):
        share = (course.parameter[probe] - p0) * per_span
        x = course.base[probe]
        for axis in range(3):
            there = start[axis] + share * (end[axis] - start[axis])
            x += course.normal[probe, axis] * there
        cost += _at_probe(course, probe, x)
    for axis in range(3):
        moved = two.corrected[b, j, axis] - one.corrected[a, i, axis]
        cost += course.still[k, axis] * moved**2
        cost += course.stays[k] * two.off[b, j, axis] ** 2
    return cost


@njit(cache=True, nogil=True)
def best_points(course, exact, points, ends, count):
    """Points of some ends that leave least if their neighbours were not rounded, (E, count).

    `exact` has one point for each of all ends, and one more for the start of the path, in front.
    """
    found = np.zeros((len(ends), count), np.int64)
    for e, k in enumerate(ends):
        tries = points.parameter.shape[1]
        cost = np.empty(tries)
        for j in range(tries):
            cost[j] = _left(course, k, exact, k, 0, points, e, j)
            if k + 1 < len(course.begin):
                cost[j] += _left(course, k + 1, points, e, j, exact, k + 2, 0)
        found[e] = np.argsort(cost)[:count]
    return found


def best_sequence(course, exact, points):
    """Point of every end, (K,), so that the sum of costs along the path is smallest.

    No piece costs less than nothing: what is dearer before a piece than the best so far behind it
    needs no look. Of equals the first counts.
    """
    came_from = np.zeros(points.parameter.shape, np.int8)
    total = advance(course, exact, points, 0, np.zeros(came_from.shape[1]), came_from)
    return traced_back(total, came_from)


@njit(cache=True, nogil=True)
def advance(course, exact, points, at, total, came_from):
    """Go on along the path with the points of some more ends.

    Parameters
    ----------
    course, exact : Course, Points
        Of all ends, `exact` as in `best_points`.
    points : Points
        Of as many ends, from the first on.
    at : int
        First end that is new: 0, or 1 where the path has come to the first one already.
    total : (C,) float64
        Least cost to every point of the end before `at`.
    came_from : (K, C) int8
        The point before on the way there; that of the new ends is filled in.

    Returns
    -------
    (C,) float64
        Least cost to every point of the last end, over the least of all.
    """
    ends, tries = points.parameter.shape
    room = _most_probes(course, points)
    by_start, by_end = np.empty((tries, room)), np.empty((tries, room))
    if at == 0:
        total = np.array([_left(course, 0, exact, 0, 0, points, 0, j) for j in range(tries)])
    for k in range(1, ends):
        now = np.full(tries, np.inf)
        cheapest_first = np.argsort(total)
        count = _shares(course, k, points, by_start, by_end)
        for j in range(tries):
            for i in cheapest_first:
                if total[i] > now[j]:
                    break
                if count < 0:
                    cost = total[i] + _left(course, k, points, k - 1, i, points, k, j)
                else:
                    cost = total[i] + _at_ends(course, k, points, i, j)
                    begin = course.begin[k]
                    for n in range(count):
                        if cost > now[j]:
                            break
                        cost += _at_probe(course, begin + n, by_start[i, n] + by_end[j, n])
                if cost < now[j] or (cost == now[j] and i < came_from[k, j]):
                    now[j], came_from[k, j] = cost, i
        total = now - now.min()
    return total


@njit(cache=True)
def traced_back(total, came_from):
    """Point of every end, (K,), on the cheapest way to the last."""
    best = np.zeros(len(came_from), np.int64)
    point = np.argmin(total)
    for k in range(len(came_from) - 1, -1, -1):
        best[k] = point
        point = came_from[k, point]
    return best


@njit(cache=True)
def _most_probes(course, points):
    """Probes of the piece that has most."""
    most = 1
    for k in range(len(points.bound)):
        if course.begin[k] >= 0:
            most = max(most, points.bound[k].max() - course.begin[k])
    return most


@njit(cache=True)
def _shares(course, k, points, by_start, by_end):
    """What every start and every end of piece k add at its probes; how many these are.

    -1 where the points of an end lie at different places, so that the shares are not theirs alone.
    """
    first, p0 = course.begin[k], course.start[k]
    last, p1 = points.bound[k, 0], points.parameter[k, 0]
    if first < 0 or (points.bound[k] != last).any() or (points.parameter[k] != p1).any():
        return -1
    per_span = 1.0 / (p1 - p0) if p1 > p0 else 0.0
    for n in range(last - first):
        normal = course.normal[first + n]
        share = (course.parameter[first + n] - p0) * per_span
        for t in range(points.parameter.shape[1]):
            start, end = points.at_start[k - 1, t], points.at_end[k, t]
            by_start[t, n] = (1.0 - share) * (
                normal[0] * start[0] + normal[1] * start[1] + normal[2] * start[2]
            )
            by_end[t, n] = course.base[first + n] + share * (
                normal[0] * end[0] + normal[1] * end[1] + normal[2] * end[2]
            )
    return max(last - first, 0)


@njit(cache=True)
def _at_probe(course, probe, x):
    """Cost of what is left at a probe."""
    if x > 0.0 and course.only_below[probe]:
        return 0.0
    square = x * x
    return course.weight[probe] * (square + course.large * square**4)


@njit(cache=True)
def _at_ends(course, k, points, i, j):
    """Cost of piece k by the places of its ends alone."""
    cost = 0.0
    for axis in range(3):
        moved = points.corrected[k, j, axis] - points.corrected[k - 1, i, axis]
        cost += course.still[k, axis] * moved**2
        cost += course.stays[k] * points.off[k, j, axis] ** 2
    return cost
