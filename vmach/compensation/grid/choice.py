"""The sequence of grid points that leaves least at the probes, by dynamic programming.

Source: R. Bellman, Dynamic Programming (1957).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stock.compiled import njit_inlined, njit_kernel, njit_maker

__all__ = ["Course", "Points", "advance", "best_points", "traced_back"]


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


@njit_inlined()
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


@njit_maker()
def best_points(course, exact, points, ends, count):
    """Points of some ends that leave least if their neighbours were not rounded, (E, count).

    `exact` has one point for each of all ends, and one more for the start of the path, in front.
    """
    found = np.zeros((len(ends), count), np.int64)
    cost = np.empty(points.parameter.shape[1])
    for e, k in enumerate(ends):
        _fill_costs(course, exact, points, (e, k), cost)
        found[e] = np.argsort(cost)[:count]
    return found


@njit_kernel()
def _fill_costs(course, exact, points, end, cost):
    """Cost of every point of one end between neighbours that are not rounded."""
    e, k = end
    for j in range(len(cost)):
        cost[j] = _left(course, k, exact, k, 0, points, e, j)
        if k + 1 < len(course.begin):
            cost[j] += _left(course, k + 1, points, e, j, exact, k + 2, 0)


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
        Least cost to every point of the last end, over the least of all; infinite for points
        that are the same as one before.
    """
    tries, total = points.parameter.shape[1], total.copy()
    shares = np.empty((2, _most_probes(course.begin, points.bound), tries))
    room = np.empty((2, tries), np.int64), np.empty((3, tries)), shares
    _advance(course, exact, points, (at, came_from, total), room)
    return total


@njit_kernel()
def _advance(course, exact, points, goes_on, room):
    """`advance`, with room to work in; the total is changed in place."""
    at, came_from, total = goes_on
    (before, here), (now, stays, cost), shares = room
    known = _different(points, 0, before)
    if at == 0:
        total[:] = np.inf
        for a in range(known):
            total[before[a]] = _left(course, 0, exact, 0, 0, points, 0, before[a])
    for k in range(1, len(points.bound)):
        _sort_by_cost(total, before, known)
        count = _different(points, k, here)
        own = before, known, here, count
        probes = _fill_shares(course, k, points, own, shares)
        for b in range(count):
            stays[b] = _stays(course, k, points, here[b])
            now[b] = np.inf
        for a in range(known):
            i = before[a]
            if total[i] > _largest(now, count):  # no piece costs less than nothing
                break
            _fill_costs_from(course, k, points, (own, a, total[i], probes, shares, stays), cost)
            for b in range(count):
                j = here[b]
                if cost[b] < now[b] or (cost[b] == now[b] and i < came_from[k, j]):
                    now[b], came_from[k, j] = cost[b], i
        _put_over_least((now, here, count), total)
        before, here, known = here, before, count


@njit_inlined()
def _fill_costs_from(course, k, points, way, cost):
    """Least cost to every point of end k by one point before it."""
    (before, _, here, count), a, so_far, probes, shares, stays = way
    i, still = before[a], course.still
    if probes < 0:
        for b in range(count):
            cost[b] = so_far + _left(course, k, points, k - 1, i, points, k, here[b])
        return
    if still[k, 0] == 0.0 and still[k, 1] == 0.0 and still[k, 2] == 0.0:
        for b in range(count):
            cost[b] = so_far + stays[b]
    else:
        for b in range(count):
            cost[b] = so_far + _at_ends(course, k, points, i, here[b])
    for n in range(probes):
        probe = course.begin[k] + n
        weight, start = course.weight[probe], shares[0, n, a]
        most = 0.0 if course.only_below[probe] else np.inf
        for b in range(count):
            x = min(start + shares[1, n, b], most)
            square = x * x
            cost[b] += weight * (square + course.large * square**4)


@njit_inlined()
def _different(points, k, own):
    """Fill in the points of end k without those that are the same as one before; how many.

    Along a line that goes on, as many points about an end are found from both its sides.
    """
    count = 0
    for j in range(points.bound.shape[1]):
        is_new = True
        for a in range(count):
            if _same(points, k, own[a], j):
                is_new = False
                break
        if is_new:
            own[count] = j
            count += 1
    return count


@njit_inlined()
def _same(points, k, i, j):
    """Whether two points of end k have all in common."""
    if points.bound[k, i] != points.bound[k, j] or points.parameter[k, i] != points.parameter[k, j]:
        return False
    for places in (points.off, points.corrected, points.at_end, points.at_start):
        for axis in range(3):
            if places[k, i, axis] != places[k, j, axis]:
                return False
    return True


@njit_inlined()
def _sort_by_cost(total, own, count):
    """Put some points in order, the cheapest first."""
    for a in range(1, count):
        one, b = own[a], a
        while b > 0 and total[own[b - 1]] > total[one]:
            own[b] = own[b - 1]
            b -= 1
        own[b] = one


@njit_inlined()
def _largest(values, count):
    found = -np.inf
    for b in range(count):
        found = max(found, values[b])
    return found


@njit_inlined()
def _put_over_least(costs, total):
    """Write the costs of some points over the least of them; the others' are infinite."""
    now, here, count = costs
    least = np.inf
    for b in range(count):
        least = min(least, now[b])
    total[:] = np.inf
    for b in range(count):
        total[here[b]] = now[b] - least


def traced_back(total, came_from):
    """Point of every end, (K,), on the cheapest way to the last."""
    best = np.zeros(len(came_from), np.int64)
    _trace_back(np.argmin(total), came_from, best)
    return best


@njit_kernel()
def _trace_back(point, came_from, best):
    for k in range(len(came_from) - 1, -1, -1):
        best[k] = point
        point = came_from[k, point]


def _most_probes(begin, bound):
    """Probes of the piece that has most."""
    begin = begin[: len(bound)]
    return int((bound.max(axis=1) - begin).max(initial=1, where=begin >= 0))


@njit_inlined()
def _fill_shares(course, k, points, own, shares):
    """What every start and every end of piece k add at its probes; how many these are.

    -1 where the points of an end lie at different places, so that the shares are not theirs alone.
    """
    before, known, here, count = own
    first, p0 = course.begin[k], course.start[k]
    last, p1 = points.bound[k, 0], points.parameter[k, 0]
    if first < 0:
        return -1
    for b in range(1, count):
        if points.bound[k, here[b]] != last or points.parameter[k, here[b]] != p1:
            return -1
    per_span = 1.0 / (p1 - p0) if p1 > p0 else 0.0
    for n in range(last - first):
        share = (course.parameter[first + n] - p0) * per_span
        for a in range(known):
            along = _along(course.normal, first + n, points.at_start, k - 1, before[a])
            shares[0, n, a] = (1.0 - share) * along
        for b in range(count):
            along = _along(course.normal, first + n, points.at_end, k, here[b])
            shares[1, n, b] = course.base[first + n] + share * along
    return max(last - first, 0)


@njit_inlined()
def _along(normal, probe, places, k, j):
    """Component of a place along the normal of a probe."""
    x, y, z = places[k, j, 0], places[k, j, 1], places[k, j, 2]
    return normal[probe, 0] * x + normal[probe, 1] * y + normal[probe, 2] * z


@njit_inlined()
def _at_probe(course, probe, x):
    """Cost of what is left at a probe."""
    if x > 0.0 and course.only_below[probe]:
        return 0.0
    square = x * x
    return course.weight[probe] * (square + course.large * square**4)


@njit_inlined()
def _stays(course, k, points, j):
    """Cost of the whole distance of point j of end k."""
    cost = 0.0
    for axis in range(3):
        cost += course.stays[k] * points.off[k, j, axis] ** 2
    return cost


@njit_inlined()
def _at_ends(course, k, points, i, j):
    """Cost of piece k by the places of its ends alone."""
    cost = 0.0
    for axis in range(3):
        moved = points.corrected[k, j, axis] - points.corrected[k - 1, i, axis]
        cost += course.still[k, axis] * moved**2
        cost += course.stays[k] * points.off[k, j, axis] ** 2
    return cost
