"""Compiled Delaunay triangulation of points in a plane, and which triangles share a side.

Points are inserted one by one; sides are exchanged until no circle about a triangle holds another
point. One vertex at infinity closes the outline, so points outside it need no case of their own.
The order, random rounds that double, each along a Z curve, keeps the ways to the next point short.

Source: L. Guibas and J. Stolfi, ACM Trans. Graphics 4 (1985) 74 (incremental insertion, the test
of the circle); N. Amenta et al., Proc. 19th Symp. Comput. Geom. (2003) 211 (order of insertion).
"""

from __future__ import annotations

import numpy as np

from stock.compiled import njit_maker, njit_part

__all__ = ["centres", "delaunay"]

#: bits of each coordinate in the place along the Z curve
_BITS = 12

#: 2**32 divided by the golden ratio
_GOLDEN = 2654435769

#: where the window of tiled triangles begins, in periods: its border meets no symmetry
_WINDOW = -0.0741


def delaunay(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles, and what lies beyond each of their sides.

    Parameters
    ----------
    points : (N, 2) float64
        No two the same. Of four on one circle rounding decides.

    Returns
    -------
    triangles : (T, 3) int64
        Counter-clockwise. None where all points lie on one line.
    beyond : (T, 3) int64
        Of the side from corner k to the next: three times the triangle beyond it, plus the number
        of that side there; -1 at the outline.
    """
    if len(points) < 3:
        return np.empty((0, 3), np.int64), np.empty((0, 3), np.int64)
    points = np.ascontiguousarray(points)
    return _triangulated(points, np.argsort(_places(points)))


@njit_maker()
def _places(points):
    """Numbers that sort points (N, 2) in rounds, each twice as large as all before it."""
    low_x, low_y = points[:, 0].min(), points[:, 1].min()
    size = max(points[:, 0].max() - low_x, points[:, 1].max() - low_y)
    cells = (2**_BITS - 1) / size if size > 0.0 else 0.0
    places = np.empty(len(points), np.int64)
    for n in range(len(points)):
        x, y = int((points[n, 0] - low_x) * cells), int((points[n, 1] - low_y) * cells)
        place = 0
        for bit in range(_BITS):
            place |= ((x >> bit) & 1) << (2 * bit) | ((y >> bit) & 1) << (2 * bit + 1)
        # multiples of the golden ratio's share of the range are spread evenly over it
        turn, latest_round = (n * _GOLDEN) % 2**32, 0
        while turn > 0:
            turn, latest_round = turn >> 1, latest_round + 1
        places[n] = latest_round << (2 * _BITS) | place
    return places


@njit_maker()
def _triangulated(points, order):
    """Triangles and what lies beyond their sides, of points inserted in an order (N,)."""
    far = len(points)
    corner, beyond = np.empty(6 * far + 6, np.int64), np.empty(6 * far + 6, np.int64)
    order = order.copy()
    if not _third_off_line(points, order):
        return np.empty((0, 3), np.int64), np.empty((0, 3), np.int64)
    _first_triangle(points, order[:3], far, corner, beyond)
    count, here, waiting = 4, 0, np.empty(6 * far + 6, np.int64)
    for n in range(3, far):
        here = _triangle_at(points, order[n], far, corner, beyond, here, count)
        _insert(order[n], here, count, corner, beyond)
        waiting[0], waiting[1], waiting[2] = 3 * here, 3 * count, 3 * count + 3
        count += 2
        _exchange_sides(points, far, corner, beyond, waiting, 3)
    return _without_far(far, count, corner, beyond)


@njit_part()
def _left(points, a, b, c):
    """Twice the area of the triangle a, b, c: positive where c is left of the way from a to b."""
    ax, ay = points[a, 0], points[a, 1]
    return (points[b, 0] - ax) * (points[c, 1] - ay) - (points[b, 1] - ay) * (points[c, 0] - ax)


@njit_part()
def _in_circle(points, a, b, c, d):
    """Positive where d lies in the circle about the triangle a, b, c (counter-clockwise)."""
    dx, dy = points[d, 0], points[d, 1]
    ax, ay = points[a, 0] - dx, points[a, 1] - dy
    bx, by = points[b, 0] - dx, points[b, 1] - dy
    cx, cy = points[c, 0] - dx, points[c, 1] - dy
    aa, bb, cc = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
    return ax * (by * cc - bb * cy) - ay * (bx * cc - bb * cx) + aa * (bx * cy - by * cx)


@njit_part()
def _third_off_line(points, order):
    """Bring a point that is not on the line of the first two to the third place, if any is."""
    for n in range(2, len(order)):
        if _left(points, order[0], order[1], order[n]) != 0.0:
            order[2], order[n] = order[n], order[2]
            return True
    return False


@njit_part()
def _first_triangle(points, three, far, corner, beyond):
    """A triangle, and the three between its sides and the vertex at infinity."""
    a, b, c = three[0], three[1], three[2]
    if _left(points, a, b, c) < 0.0:
        b, c = c, b
    corners = (a, b, c, b, a, far, c, b, far, a, c, far)
    sides = (3, 6, 9, 0, 11, 7, 1, 5, 10, 2, 8, 4)
    for k in range(12):
        corner[k], beyond[k] = corners[k], sides[k]


@njit_part()
def _far_side(corner, triangle, far):
    """The side of a triangle that is opposite to the vertex at infinity; -1 if there is none."""
    for k in range(3):
        if corner[3 * triangle + k] == far:
            return 3 * triangle + (k + 1) % 3
    return -1


@njit_part()
def _triangle_at(points, new, far, corner, beyond, start, count):
    """The triangle that holds a point, or one of those at infinity that it sees from outside."""
    here = start
    side = _far_side(corner, here, far)
    if side >= 0:
        here = beyond[side] // 3
    for _ in range(count):
        crossed = -1
        for k in range(3):
            if _left(points, corner[3 * here + k], corner[3 * here + (k + 1) % 3], new) < 0.0:
                crossed = beyond[3 * here + k]
                break
        if crossed < 0:
            return here
        here = crossed // 3
        if _far_side(corner, here, far) >= 0:
            return here
    return _triangle_by_all(points, new, far, corner, count)


@njit_part()
def _triangle_by_all(points, new, far, corner, count):
    """The triangle that a point lies in, or least outside of: where rounding leads in a circle."""
    found, best = 0, -np.inf
    for t in range(count):
        if _far_side(corner, t, far) < 0:
            least = np.inf
            for k in range(3):
                a, b = corner[3 * t + k], corner[3 * t + (k + 1) % 3]
                least = min(least, _left(points, a, b, new))
            if least > best:
                found, best = t, least
    return found


@njit_part()
def _insert(new, t, count, corner, beyond):
    """Cut a triangle in three about a point: itself, and two at the end, the point last in each."""
    v0, v1, v2 = corner[3 * t], corner[3 * t + 1], corner[3 * t + 2]
    one, two = 3 * count, 3 * count + 3
    n1, n2 = beyond[3 * t + 1], beyond[3 * t + 2]
    corner[3 * t + 2] = new
    corner[one], corner[one + 1], corner[one + 2] = v1, v2, new
    corner[two], corner[two + 1], corner[two + 2] = v2, v0, new
    _join(beyond, one, n1)
    _join(beyond, two, n2)
    _join(beyond, 3 * t + 1, one + 2)
    _join(beyond, one + 1, two + 2)
    _join(beyond, two + 1, 3 * t + 2)


@njit_part()
def _join(beyond, one, other):
    beyond[one], beyond[other] = other, one


@njit_part()
def _exchange_sides(points, far, corner, beyond, waiting, count):
    """Exchange the sides that wait, (count,), and those that this touches, where that is better.

    Each is the first side of its triangle, with the new point opposite.
    """
    while count > 0:
        count -= 1
        side = waiting[count]
        other = beyond[side]
        t, u = side - side % 3, other - other % 3
        a, b, new = corner[t], corner[t + 1], corner[t + 2]
        ahead, behind = u + (other + 1) % 3, u + (other + 2) % 3
        apex = corner[behind]
        if not _is_better(points, far, a, b, new, apex):
            continue
        beyond_ahead, beyond_behind, beyond_t = beyond[ahead], beyond[behind], beyond[t + 1]
        corner[t + 1] = apex
        corner[u], corner[u + 1], corner[u + 2] = apex, b, new
        _join(beyond, t, beyond_ahead)
        _join(beyond, u, beyond_behind)
        _join(beyond, u + 1, beyond_t)
        _join(beyond, t + 1, u + 2)
        waiting[count], waiting[count + 1] = t, u
        count += 2


@njit_part()
def _is_better(points, far, a, b, new, apex):
    """Whether a side from `apex` to the new point is to take the place of the one from a to b."""
    if apex == far:
        return False
    if a == far:
        return _left(points, apex, b, new) > 0.0
    if b == far:
        return _left(points, a, apex, new) > 0.0
    if _in_circle(points, a, b, new, apex) <= 0.0:
        return False
    # a side may only be exchanged within a convex outline: rounding decides where three are in line
    return _left(points, a, apex, new) > 0.0 and _left(points, apex, b, new) > 0.0


@njit_part()
def _is_far(corner, triangle, far):
    return _far_side(corner, triangle, far) >= 0


@njit_maker()
def _without_far(far, count, corner, beyond):
    """Triangles (T, 3) and what lies beyond (T, 3), without those that reach to infinity."""
    number, kept = np.empty(count, np.int64), 0
    for t in range(count):
        number[t] = -1 if _is_far(corner, t, far) else kept
        kept += number[t] >= 0
    triangles, sides = np.empty((kept, 3), np.int64), np.empty((kept, 3), np.int64)
    for t in range(count):
        if number[t] < 0:
            continue
        for k in range(3):
            other = beyond[3 * t + k]
            triangles[number[t], k] = corner[3 * t + k]
            neighbour = number[other // 3]
            sides[number[t], k] = 3 * neighbour + other % 3 if neighbour >= 0 else -1
    return triangles, sides


@njit_maker()
def centres(points, triangles, scale, periods, flat):
    """Centres of triangles (T, 3), and which are no slivers and lie in one window, (T,).

    Points (N, 2) are tiled: of equal triangles one has its centre in a window of the periods (2,),
    which are 0 where nothing is tiled. Slivers are no higher than `flat` in lengths, which
    `scale` (2,) makes of the points.
    """
    centre, kept = np.empty((len(triangles), 2)), np.empty(len(triangles), dtype=np.bool_)
    sides, origin = np.empty((3, 2)), _WINDOW * periods
    for t in range(len(triangles)):
        inside, longest = True, 0.0
        for axis in range(2):
            total = 0.0
            for k in range(3):
                here = points[triangles[t, k], axis]
                total += here
                sides[k, axis] = (points[triangles[t, (k + 1) % 3], axis] - here) * scale[axis]
            centre[t, axis] = total / 3.0
            off = centre[t, axis] - origin[axis]
            inside &= periods[axis] == 0.0 or 0.0 <= off < periods[axis]
        for k in range(3):
            longest = max(longest, np.hypot(sides[k, 0], sides[k, 1]))
        area = (sides[0, 0] * sides[1, 1] - sides[0, 1] * sides[1, 0]) / 2.0
        kept[t] = inside and area > flat * longest
    return centre, kept
