"""Which edges of a face, on its surface, have other points too near to be sides of triangles.

Source: J. Ruppert, J. Algorithms 18 (1995) 548: a segment is a side of the Delaunay triangulation
if no other point lies in the circle over it.
"""

from __future__ import annotations

import numpy as np

from stock.compiled import njit_maker, njit_part

__all__ = ["crowded_segments"]

#: the ends of a segment lie on its circle, but for rounding
_INSIDE = 1.0 - 1e-6


@njit_maker()
def crowded_segments(segments, inner, scale, periods):
    """Mask of the segments (S, 2, 2) whose circle holds another end or an inner point, (S,).

    Inner points are (P, 2). All are parameters of a surface, which `scale` (2,) makes lengths;
    `periods` (2,) are 0 where it does not close.
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
    crowded, middle = np.empty(count, dtype=np.bool_), np.empty(2)
    for s in range(count):
        square = 0.0
        for axis in range(2):
            half = (segments[s, 1, axis] - segments[s, 0, axis]) / 2.0
            square += (half * scale[axis]) ** 2
            middle[axis] = _wrapped((segments[s, 0, axis] + half) * scale[axis], box[axis])
        reach = np.sqrt(square) * _INSIDE
        at, beside = middle[along], middle[1 - along]
        crowded[s] = _is_any_near(ordered, across, at, beside, reach, box[1 - along])
        for turn in (-box[along], box[along]):
            if turn != 0.0 and not crowded[s]:
                crowded[s] = _is_any_near(ordered, across, at + turn, beside, reach, box[1 - along])
    return crowded


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
