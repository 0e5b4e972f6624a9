"""The fewest straight pieces inside a tube around a curve.

Source: L. Guibas, J. Hershberger, J. Mitchell and J. Snoeyink, Approximating polygons and
subdivisions with minimum-link paths, Int. J. Comput. Geom. Appl. 3 (1993) 383.
"""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["fewest_pieces"]

#: corners of a set of lines that are kept; with half of them it is a smaller set of lines
_CORNERS = 64
#: slack of comparisons in half widths of the tube
_SLACK = 1e-9


def fewest_pieces(
    place: np.ndarray, curve: np.ndarray, half_width: np.ndarray, *, start: np.ndarray,
    end: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:  # fmt: skip
    """A polyline of few pieces whose distance from a sampled curve stays inside a tube.

    The vertices need not lie on the curve: a parabola of sagitta d takes sqrt(d / (2 w)) pieces
    and not the sqrt(d / w) of a polyline that interpolates it. Greedy: every piece goes as far as
    some line from the places that the piece before can reach stays in the tube. The lines
    (value, slope) of one component that do are a convex polygon, cut smaller by every sample.

    Parameters
    ----------
    place : (n,) float64
        Increasing.
    curve : (n, c) float64
        Components of the curve there.
    half_width : (c,) float64
        Of the tube, above 0, in each component.
    start, end : (2, c) float64
        Lowest and highest value at either end, relative to the curve, not beyond the tube. Where
        there is a choice, vertices are near the curve.

    Returns
    -------
    vertex : (m + 1,) int64
        Samples at which the m pieces begin and end.
    off : (m + 1, c) float64
        The polyline there, relative to the curve.
    """
    x = np.ascontiguousarray(place - place[0])
    y = np.ascontiguousarray((curve - curve[0]) / half_width)
    vertex, value = _pieces(x, y, start / half_width, end / half_width + y[-1])
    return vertex, (value - y[vertex]) * half_width


@njit(cache=True)
def _pieces(x, y, begin, last):
    """`fewest_pieces` with half widths of 1, for a curve that begins at 0."""
    count, parts = y.shape
    vertex, low, high = [0], [begin[0].copy()], [begin[1].copy()]
    lines = np.empty((parts, _CORNERS, 2))
    corners = np.zeros(parts, np.int64)
    here, index = 0, 1
    while index < count:
        trial, trial_corners = lines.copy(), corners.copy()
        fits = True
        for part in range(parts):
            bottom, top = y[index, part] - 1.0, y[index, part] + 1.0
            if index == count - 1:
                bottom, top = last[0, part], last[1, part]
            way = x[index] - x[here]
            if index == here + 1:
                trial_corners[part] = _first_lines(
                    trial[part], low[-1][part], high[-1][part], way, bottom, top
                )
            else:
                kept = _cut(trial[part], trial_corners[part], way, top, 1.0)
                trial_corners[part] = _cut(trial[part], kept, way, bottom, -1.0)
            fits = fits and trial_corners[part] > 0
        if fits:
            lines, corners, index = trial, trial_corners, index + 1
        if not fits or index == count:
            here = index - 1
            bottom_reached, top_reached = np.empty(parts), np.empty(parts)
            way = x[here] - x[vertex[-1]]
            for part in range(parts):
                ends = lines[part, : corners[part], 0] + way * lines[part, : corners[part], 1]
                bottom_reached[part], top_reached[part] = ends.min(), ends.max()
            vertex.append(here)
            low.append(bottom_reached)
            high.append(top_reached)
    return _settled(x, y, vertex, low, high)


@njit(cache=True)
def _first_lines(lines, low, high, way, bottom, top):
    """Corners of the set of lines from [low, high] that reach [bottom, top]."""
    lines[0] = low, (bottom - low) / way
    lines[1] = high, (bottom - high) / way
    lines[2] = high, (top - high) / way
    lines[3] = low, (top - low) / way
    return 4


@njit(cache=True)
def _cut(lines, corners, way, bound, sign):
    """Keep the lines with ``sign * (value + way * slope) <= sign * bound``; corners left."""
    kept = np.empty((2 * corners + 2, 2))
    count = 0
    for k in range(corners):
        one, two = lines[k], lines[(k + 1) % corners]
        over_one = sign * (one[0] + way * one[1] - bound)
        over_two = sign * (two[0] + way * two[1] - bound)
        if over_one <= _SLACK:
            kept[count] = one
            count += 1
        if (over_one <= _SLACK) != (over_two <= _SLACK):
            kept[count] = one + (two - one) * (over_one / (over_one - over_two))
            count += 1
    stride = 1 + count // (_CORNERS - 1)
    lines[: (count + stride - 1) // stride] = kept[:count:stride]
    return (count + stride - 1) // stride


@njit(cache=True)
def _settled(x, y, vertex, low, high):
    """One polyline of those that fit, from its end backwards, near the curve at its vertices."""
    pieces, parts = len(vertex) - 1, y.shape[1]
    value = np.empty((pieces + 1, parts))
    value[pieces] = np.minimum(np.maximum(y[vertex[pieces]], low[pieces]), high[pieces])
    for piece in range(pieces - 1, -1, -1):
        first, stop = vertex[piece], vertex[piece + 1]
        for part in range(parts):
            goal = value[piece + 1, part]
            least, most = low[piece][part], high[piece][part]
            for k in range(first + 1, stop):
                share = (x[stop] - x[first]) / (x[stop] - x[k])
                least = max(least, goal + (y[k, part] - 1.0 - goal) * share)
                most = min(most, goal + (y[k, part] + 1.0 - goal) * share)
            wanted = y[first, part]
            value[piece, part] = min(max(wanted, least), max(least, most))
    return np.array(vertex), value
