"""Compiled crossings of the edges of a face with lines of constant u or v.

Source: closed form derived here: where a segment crosses a line of constant u or v, by linear
interpolation.
"""

from __future__ import annotations

import numpy as np

from stock.compiled import njit_maker, njit_part

__all__ = [
    "INSIDE",
    "MEETS_NO_EDGE",
    "OUTSIDE",
    "interpolated",
    "intervals_of_rows",
    "line_crossings",
    "polyline_segments",
    "sides_of_points",
]

OUTSIDE, INSIDE, MEETS_NO_EDGE = 0, 1, 2

#: bands are made wider until a segment reaches into no more of them on average
_CROWD = 8.0

#: a row whose v differs from that of a whole segment by less than this runs along it
_ALONG = 1e-7
#: where one segment ends and the next begins, their v differ by rounding, by less than this
_ROUNDING = 1e-9


@njit_maker()
def polyline_segments(points, uv, after, periods):
    """Segments of polylines one behind the other: in space (S, 2, 3), and in u and v (S, 2, 2).

    Points are (P, 3) with parameters (P, 2); `after` (L,) are the places behind their ends. The
    end of a segment is on the same turn as its start.
    """
    count = len(points) - len(after)
    in_space, in_uv = np.empty((count, 2, 3)), np.empty((count, 2, 2))
    s = start = 0
    for end in after:
        for n in range(start, end - 1):
            in_space[s, 0], in_space[s, 1] = points[n], points[n + 1]
            for axis in range(2):
                step = uv[n + 1, axis] - uv[n, axis]
                if periods[axis] > 0.0:
                    step -= periods[axis] * np.rint(step / periods[axis])
                in_uv[s, 0, axis], in_uv[s, 1, axis] = uv[n, axis], uv[n, axis] + step
            s += 1
        start = end
    return in_space, in_uv


@njit_part()
def _crossing(start, end, axis, value, period):
    """Whether a segment crosses uv[axis] = value, the other coordinate there, and if upwards.

    With a period, `value` stands for all that differ from it by whole turns; a segment is shorter
    than half of one.
    """
    low, high = start[axis] - value, end[axis] - value
    if period > 0.0:
        low_side, high_side = np.floor(low / period), np.floor(high / period)
    else:
        low_side, high_side = 1.0 if low >= 0.0 else 0.0, 1.0 if high >= 0.0 else 0.0
    if low_side == high_side:
        return False, 0.0, False
    target = value + period * max(low_side, high_side)
    share = (target - start[axis]) / (end[axis] - start[axis])
    other = start[1 - axis] + share * (end[1 - axis] - start[1 - axis])
    return True, other, high_side > low_side


@njit_maker()
def line_crossings(segments, axis, period):
    """Where segments (S, 2, 2) cross a line of constant uv[axis]: the other coordinate, (C,).

    Also whether each crosses it upwards. The line leads through the segment that reaches farthest
    along the axis. It keeps away from the ends of all: two that meet there differ by rounding, so
    a line through them crosses both, or neither.
    """
    low = high = 0.0
    for s in range(len(segments)):
        one, end = segments[s, 0, axis], segments[s, 1, axis]
        if abs(end - one) > high - low:
            low, high = min(one, end), max(one, end)
    place, count = np.empty(2 * len(segments) + 2), 2
    place[0], place[1] = low, high
    for s in range(len(segments)):
        for end in range(2):
            at = segments[s, end, axis]
            at = low + (at - low) % period if period > 0.0 else at
            if low < at < high:
                place[count] = at
                count += 1
    place = np.sort(place[:count])
    value = (low + high) / 2.0
    widest = 0.0
    for k in range(count - 1):
        if place[k + 1] - place[k] > widest:
            widest, value = place[k + 1] - place[k], (place[k] + place[k + 1]) / 2.0
    other, upward, found = np.empty(len(segments)), np.empty(len(segments), dtype=np.bool_), 0
    for s in range(len(segments)):
        crosses, at, up = _crossing(segments[s, 0], segments[s, 1], axis, value, period)
        if crosses:
            other[found], upward[found] = at, up
            found += 1
    return other[:found].copy(), upward[:found].copy()


@njit_maker()
def intervals_of_rows(segments, levels, u_period, v_period):
    """Intervals of u that the face covers at levels of v, (R,).

    Returns the row of each interval (I,), its ends (I, 2), and whether each row meets an edge,
    (R,). An interval over a seam ends beyond the period.
    """
    row, ends = np.empty(64, dtype=np.int64), np.empty((64, 2))
    meets = np.zeros(len(levels), dtype=np.bool_)
    place, begins = np.empty(len(segments)), np.empty(len(segments), dtype=np.bool_)
    total = 0
    for r in range(len(levels)):
        level = _beside_edges(segments, levels[r], v_period)
        count = 0
        for s in range(len(segments)):
            crosses, u, up = _crossing(segments[s, 0], segments[s, 1], 1, level, v_period)
            if not crosses:
                continue
            u = u % u_period if u_period > 0.0 else u
            k = count  # kept in order; at one place the ends come before the beginnings
            while k > 0 and (place[k - 1] > u or (place[k - 1] == u and begins[k - 1] and up)):
                place[k], begins[k] = place[k - 1], begins[k - 1]
                k -= 1
            place[k], begins[k] = u, not up
            count += 1
        meets[r] = count > 0
        for k in range(count):
            following = place[k + 1] if k + 1 < count else place[0] + u_period
            if begins[k] and not begins[(k + 1) % count] and following > place[k]:
                if total == len(row):
                    row = np.concatenate((row, np.empty_like(row)))
                    ends = np.concatenate((ends, np.empty_like(ends)))
                row[total], ends[total, 0], ends[total, 1] = r, place[k], following
                total += 1
    return row[:total].copy(), ends[:total].copy(), meets


@njit_maker()
def interpolated(at, row, x, y):
    """Values y (R, N) of rows at places (P,) between their x (R, N), which increase."""
    found = np.empty(len(at))
    for p in range(len(at)):
        r = row[p]
        k = max(min(_places_up_to(x[r], at[p]), x.shape[1] - 1), 1)
        width = x[r, k] - x[r, k - 1]
        share = (at[p] - x[r, k - 1]) / width if width > 0.0 else 0.0
        found[p] = y[r, k - 1] + share * (y[r, k] - y[r, k - 1])
    return found


@njit_part()
def _places_up_to(increasing, value):
    """How many of the numbers (N,) are no larger than a value."""
    begin, end = 0, len(increasing)
    while begin < end:
        middle = (begin + end) // 2
        if increasing[middle] <= value:
            begin = middle + 1
        else:
            end = middle
    return begin


@njit_part()
def _beside_edges(segments, level, period):
    """A row along an edge, or through ends that differ by rounding, moved off it.

    Rounding decides what such a row crosses there: both segments that meet, or neither.
    """
    for s in range(len(segments)):
        if _is_along(segments[s, 0, 1] - level, segments[s, 1, 1] - level, period):
            return level + 2.0 * _ALONG
    return level


@njit_part()
def _is_along(one, other, period):
    """Whether a segment with its ends so far above a row lies along it, or ends all but on it."""
    if period > 0.0:
        one -= period * np.rint(one / period)
        other -= period * np.rint(other / period)
    one, other = abs(one), abs(other)
    return (one < _ALONG and other < _ALONG) or 0.0 < one < _ROUNDING or 0.0 < other < _ROUNDING


@njit_part()
def _ends_at(height, period):
    """Whether an end so far above a row lies on it, but for rounding."""
    if period > 0.0:
        height -= period * np.rint(height / period)
    return abs(height) < _ROUNDING


@njit_part()
def _bands(segments, count, low, height, first, listed):
    """List the segments by the bands of v that they reach into; return how many are listed.

    A row may be moved off an edge, into the next band: segments are listed that much further.
    With an empty `listed` they are only counted, in `first`, (count + 1,).
    """
    total = 0
    for s in range(len(segments)):
        v0, v1 = segments[s, 0, 1], segments[s, 1, 1]
        begin = _band(min(v0, v1) - 4.0 * _ALONG, low, height, count)
        end = _band(max(v0, v1) + 4.0 * _ALONG, low, height, count)
        for band in range(begin, end + 1):
            if len(listed):
                listed[first[band]] = s
                first[band] += 1
            total += 1
            if not len(listed):
                first[band + 1] += 1
    return total


@njit_part()
def _bounds_of_v(segments):
    """Least and largest v of segments (S, 2, 2)."""
    low, high = np.inf, -np.inf
    for s in range(len(segments)):
        for end in range(2):
            low, high = min(low, segments[s, end, 1]), max(high, segments[s, end, 1])
    return low, high


@njit_part()
def _band(v, low, height, count):
    if height <= 0.0 or not v >= low:  # also what is not a number
        return 0
    return int(min((v - low) / height, count - 1.0))


@njit_part()
def _span_of_bands(segments, height):
    """How many bands of a height the segments reach into, each counted for itself."""
    total = 0.0
    for s in range(len(segments)):
        total += abs(segments[s, 1, 1] - segments[s, 0, 1]) / height + 1.0
    return total


@njit_maker()
def sides_of_points(segments, uv, u_period, v_period):
    """For each point (N, 2): INSIDE, OUTSIDE, or MEETS_NO_EDGE where no edge crosses its row.

    The nearest edge towards +u decides: inside where the face ends there. Segments are looked up
    in bands of v, unless v is periodic.
    """
    low, high = _bounds_of_v(segments)
    count = 1 if v_period > 0.0 or not high > low else len(segments)
    most = _CROWD * len(segments)
    while count > 1 and _span_of_bands(segments, (high - low) / count) > most:
        count //= 2
    height = (high - low) / count if count > 1 else 0.0
    first = np.zeros(count + 1, dtype=np.int64)
    total = _bands(segments, count, low, height, first, np.empty(0, dtype=np.int64))
    for band in range(count):
        first[band + 1] += first[band]
    listed = np.empty(total, dtype=np.int64)
    _bands(segments, count, low, height, first.copy(), listed)
    sides = np.empty(len(uv), dtype=np.int8)
    for n in range(len(uv)):
        band = _band(uv[n, 1], low, height, count)
        near = listed[first[band] : first[band + 1]]
        sides[n] = _side(segments, near, uv[n], u_period, v_period)
    return sides


@njit_part()
def _side(segments, near, point, u_period, v_period):
    """Side of one point from the segments that may cross its row."""
    nearest, side, meets = np.inf, OUTSIDE, False
    level = point[1]
    for s in near:  # two edges that meet at this level, or at it but for rounding, decide nothing
        if _ends_at(segments[s, 0, 1] - level, v_period) or _ends_at(
            segments[s, 1, 1] - level, v_period
        ):
            level -= 2.0 * _ALONG
            break
    for s in near:
        crosses, u, up = _crossing(segments[s, 0], segments[s, 1], 1, level, v_period)
        if not crosses:
            continue
        meets = True
        ahead = u - point[0]
        if u_period > 0.0:
            ahead = ahead % u_period
        if 0.0 <= ahead < nearest:
            nearest, side = ahead, INSIDE if up else OUTSIDE
    return side if meets else MEETS_NO_EDGE
