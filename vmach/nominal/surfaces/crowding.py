"""Which edges of a face, on its surface, have other points too near to be sides of triangles.

Source: J. Ruppert, J. Algorithms 18 (1995) 548: a segment is a side of the Delaunay triangulation
if no other point lies in the circle over it.
"""

from __future__ import annotations

import numpy as np

from stock.compiled import njit_maker, njit_part

__all__ = ["crowded_places"]

#: the ends of a segment lie on its circle, but for rounding
_INSIDE = 1.0 - 1e-6

#: so often a segment is halved before the others are looked at again
_MOST_HALVINGS = 6


@njit_maker()
def crowded_places(segments, is_straight, length_mm, least_mm, inner, scale, periods):
    """Where to halve segments (S, 2, 2) whose circle holds another point.

    Those that are straight, (S,), are halved again where the circle over a half holds one; of the
    others the place of the halves is not known.

    Inner points are (P, 2). All are parameters of a surface, which `scale` (2,) makes lengths;
    `periods` (2,) are 0 where it does not close. Pieces no longer than `least_mm` are left.

    Returns the segment, (N,), and the share of it, (N,), of each place: its length is (S,) mm.
    """
    count = len(segments)
    points = np.empty((count + len(inner), 2))
    points[:count], points[count:] = segments[:, 0], inner
    box = periods * scale
    for n in range(len(points)):
        for axis in range(2):
            points[n, axis] = _wrapped(points[n, axis] * scale[axis], box[axis])
    along = 0 if np.ptp(points[:, 0]) >= np.ptp(points[:, 1]) else 1
    points = points[np.argsort(points[:, along])]
    ordered, across = points[:, along].copy(), points[:, 1 - along].copy()
    which, share = np.empty(64, np.int64), np.empty(64)
    waiting, middle, found = np.empty((_MOST_HALVINGS + 2, 2)), np.empty(2), 0
    for s in range(count):
        begin, step = segments[s, 0] * scale, (segments[s, 1] - segments[s, 0]) * scale
        square, left = step[0] ** 2 + step[1] ** 2, 1
        waiting[0] = 0.0, 1.0
        while left > 0:
            left -= 1
            low, high = waiting[left]
            if length_mm[s] * (high - low) <= least_mm:
                continue
            for axis in range(2):
                place = begin[axis] + step[axis] * (low + high) / 2.0
                middle[axis] = _wrapped(place, box[axis])
            reach = np.sqrt(square) * (high - low) / 2.0 * _INSIDE
            if not _is_crowded(ordered, across, middle[along], middle[1 - along], reach,
                               box[along], box[1 - along]):  # fmt: skip
                continue
            if found == len(which):
                which = np.concatenate((which, np.empty_like(which)))
                share = np.concatenate((share, np.empty_like(share)))
            which[found], share[found] = s, (low + high) / 2.0
            found += 1
            if is_straight[s] and (high - low) * 2.0**_MOST_HALVINGS > 1.0:
                waiting[left] = low, (low + high) / 2.0
                waiting[left + 1] = (low + high) / 2.0, high
                left += 2
    return which[:found].copy(), share[:found].copy()


@njit_part()
def _is_crowded(ordered, across, at, beside, reach, period, period_across):
    """Whether a point, or a copy of it one period on, is nearer to a place than `reach`."""
    if _is_any_near(ordered, across, at, beside, reach, period_across):
        return True
    return period > 0.0 and (
        _is_any_near(ordered, across, at - period, beside, reach, period_across)
        or _is_any_near(ordered, across, at + period, beside, reach, period_across)
    )


@njit_part()
def _wrapped(value, period):
    return value % period if period > 0.0 else value


@njit_part()
def _is_any_near(ordered, across, at, beside, reach, period):
    """Whether a point, in order of its first coordinate, is nearer to a place than `reach`."""
    n = np.searchsorted(ordered, at - reach)
    while n < len(ordered) and ordered[n] < at + reach:
        off = abs(across[n] - beside)
        if period > 0.0:
            off = min(off, period - off)
        if (ordered[n] - at) ** 2 + off * off < reach * reach:
            return True
        n += 1
    return False
