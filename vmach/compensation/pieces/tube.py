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
#: of a cut before it is made smaller
_ROOM = 2 * _CORNERS + 2
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
    # the sets of lines so far and with one sample more, in turn; nothing is allocated for a sample
    both, between = np.empty((2, parts, _ROOM, 2)), np.empty((_ROOM, 2))
    both_corners = np.zeros((2, parts), np.int64)
    now, here, index = 0, 0, 1
    while index < count:
        lines, corners = both[now], both_corners[now]
        trial, trial_corners = both[1 - now], both_corners[1 - now]
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
                kept = _cut(lines[part], corners[part], between, way, top, 1.0)
                trial_corners[part] = _cut(between, kept, trial[part], way, bottom, -1.0)
            fits = fits and trial_corners[part] > 0
        if fits:
            now, index = 1 - now, index + 1
            lines, corners = trial, trial_corners
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
def _cut(lines, corners, kept, way, bound, sign):
    """Put the lines with ``sign * (value + way * slope) <= sign * bound`` in `kept`; how many."""
    count = 0
    over_two = sign * (lines[0, 0] + way * lines[0, 1] - bound)
    for k in range(corners):
        after = k + 1 if k + 1 < corners else 0
        over_one, over_two = over_two, sign * (lines[after, 0] + way * lines[after, 1] - bound)
        if over_one <= _SLACK:
            kept[count, 0], kept[count, 1] = lines[k, 0], lines[k, 1]
            count += 1
        if (over_one <= _SLACK) != (over_two <= _SLACK):
            share = over_one / (over_one - over_two)
            kept[count, 0] = lines[k, 0] + (lines[after, 0] - lines[k, 0]) * share
            kept[count, 1] = lines[k, 1] + (lines[after, 1] - lines[k, 1]) * share
            count += 1
    stride = 1 + count // (_CORNERS - 1)
    left = (count + stride - 1) // stride
    for k in range(1, left):
        kept[k, 0], kept[k, 1] = kept[k * stride, 0], kept[k * stride, 1]
    return left


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
