"""One displaced tool along one sweep against one line: how near, where in, where out.

The line is p + h n. With the tool standing at s, the distance of a point of the line from the
tool is phi(h, s). The distance from the sweep is psi(h), the least phi over s. Each tool is
convex, so phi is convex in h at every s; along a straight sweep it is convex in (h, s) but for
the micrometres of the displacement, whose curvature is bounded by `ripple_of`.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from stock.compiled import njit_inlined, njit_part
from stock.motion import Motion, arc_of, bend_of, ripple_of, tilt_at, tip_at, tool_of
from stock.outline import Outlines, signed_distance

__all__ = ["TOUCH_MM", "Cut", "closest", "entry", "exit_below", "phi", "point_at"]

#: Nearer than this a sweep touches. Workpiece coordinates up to 1000 mm carry rounding of
#: 1e-13 mm, sums of a few of them 1e-12; 1e-9 mm keeps well clear of it and is a millionth
#: of a micrometre.
TOUCH_MM = 1e-9
#: a root is found when the distance there is below this, mm: the rounding of coordinates
_ROOT_MM = 2e-13
#: rounding of a distance, mm
_ROUNDING_MM = 1e-12
#: going inwards, so near an edge that it should have been reached, mm
_RIM_MM = 1e-5
#: how far ahead along the line a touch is asked whether it is more than one, mm
_PROBE_MM = 1e-3
#: the line counts as nearly parallel to the surface that it touches below this cosine
_PARALLEL = 1e-4
#: on arcs, which are not convex, Newton steps along the line begin below this distance, mm
_NEAR_MM = 1e-3
#: share of the sweep that a valley of psi has to exceed to be searched for several minima
_VALLEY = 1.0 / 32.0
_PARTS = 8


class Cut(NamedTuple):
    """What cuts: the motion of all sweeps, and the outlines of their tools."""

    motion: Motion
    outlines: Outlines


@njit_inlined()
def point_at(line, h):
    """The line's point at h."""
    p, n = line
    return (p[0] + h * n[0], p[1] + h * n[1], p[2] + h * n[2])


@njit_inlined()
def phi(cut, i, s, line, h):
    """Distance of the line's point at h from the tool of sweep i standing at s.

    Parameters
    ----------
    cut : Cut
    i : int
        Sweep.
    s : float
    line : tuple (p, n) of 3-tuples
    h : float

    Returns
    -------
    tuple of float
        phi, its first and second derivative by s, its derivative by h, and the curvature of
        the outline at the nearest point, 1/mm.
    """
    x, x1, x2, d = _seen_from_tool(cut, i, s, line, h)
    rho = math.sqrt(x[0] * x[0] + x[1] * x[1])
    value, gr, gz, curvature = signed_distance(cut.outlines, tool_of(cut.motion, i), rho, x[2])
    scale = 1.0 / max(rho, 1e-12)
    ex, ey = x[0] * scale, x[1] * scale
    radial = ex * x1[0] + ey * x1[1]
    around = ex * x1[1] - ey * x1[0]
    along = gr * x1[2] - gz * radial
    by_s = gr * radial + gz * x1[2]
    by_ss = curvature * along * along + gr * scale * around * around
    by_ss += gr * (ex * x2[0] + ey * x2[1]) + gz * x2[2]
    by_h = gr * (ex * d[0] + ey * d[1]) + gz * d[2]
    return value, by_s, by_ss, by_h, curvature


@njit_inlined()
def _seen_from_tool(cut, i, s, line, h):
    """The line's point, its first and second derivative by s, and by h, in the tool's frame."""
    p, n = line
    tip, tip1, tip2 = tip_at(cut.motion, i, s)
    x = (p[0] + h * n[0] - tip[0], p[1] + h * n[1] - tip[1], p[2] + h * n[2] - tip[2])
    x1, x2, d = (-tip1[0], -tip1[1], -tip1[2]), (-tip2[0], -tip2[1], -tip2[2]), n
    if len(cut.motion.tilt) > 0:
        x, x1, x2, d = _untilted(cut.motion, i, s, (x, x1, x2, d))
    return x, x1, x2, d


@njit_inlined()
def _untilted(motion, i, s, vectors):
    """Take the tilt off: solve x + tilt x x = y for x and its derivatives, and for d."""
    y, y1, y2, d = vectors
    t, t1, t2 = tilt_at(motion, i, s)
    x = _solved(t, y)
    x1 = _solved(t, _minus(y1, _cross(t1, x), 1.0))
    x2 = _solved(t, _minus(_minus(y2, _cross(t2, x), 1.0), _cross(t1, x1), 2.0))
    return x, x1, x2, _solved(t, d)


@njit_inlined()
def _solved(t, y):
    """x with x + t x x = y, that is (y - t x y + t (t.y)) / (1 + t.t)."""
    c = _cross(t, y)
    dot = t[0] * y[0] + t[1] * y[1] + t[2] * y[2]
    scale = 1.0 / (1.0 + t[0] * t[0] + t[1] * t[1] + t[2] * t[2])
    return (
        (y[0] - c[0] + t[0] * dot) * scale,
        (y[1] - c[1] + t[1] * dot) * scale,
        (y[2] - c[2] + t[2] * dot) * scale,
    )


@njit_inlined()
def _cross(a, b):
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


@njit_inlined()
def _minus(a, b, k):
    return (a[0] - k * b[0], a[1] - k * b[1], a[2] - k * b[2])


@njit_inlined()
def guess(cut, i, span, line, h):
    """A start for the search of the nearest s: exact for level lines and arcs about +-Z."""
    p, n = line
    motion = cut.motion
    x, y = p[0] + h * n[0], p[1] + h * n[1]
    k = arc_of(motion, i)
    if k >= 0:
        a = motion.arcs
        z = p[2] + h * n[2] - a[k, 0, 2]
        x, y = x - a[k, 0, 0], y - a[k, 0, 1]
        along = x * a[k, 1, 0] + y * a[k, 1, 1] + z * a[k, 1, 2]
        across = x * a[k, 2, 0] + y * a[k, 2, 1] + z * a[k, 2, 2]
        middle = 0.5 * (span[0] + span[1]) * a[k, 4, 2]
        turn = math.atan2(across, along) - middle
        turn -= 2.0 * math.pi * round(turn / (2.0 * math.pi))
        s = (middle + turn) / a[k, 4, 2]
    else:
        c = motion.path
        vx, vy, vz = c[i, 3], c[i, 4], c[i, 5]
        z = min(0.0, p[2] + h * n[2] - c[i, 2] - cut.outlines.height[tool_of(motion, i)])
        if z == 0.0:
            vz = 0.0
        square = vx * vx + vy * vy + vz * vz
        along = (x - c[i, 0]) * vx + (y - c[i, 1]) * vy + z * vz
        s = along / square if square > 0.0 else 0.5 * (span[0] + span[1])
    return min(max(s, span[0]), span[1])


@njit_part()
def closest(cut, i, span, line, h, s, limit):
    """psi: the least distance from the sweep's piece `span` of the line's point at h.

    Parameters
    ----------
    cut, i, line, h
        As in `phi`.
    span : tuple of float
        The piece of the sweep, as two values of s.
    s : float
        Where to start.
    limit : float
        A bound above which psi is of no interest, mm.

    Returns
    -------
    tuple of float
        psi, its derivative by h, s; (inf, 0, s) where psi is above `limit` for sure.
    """
    best = _descend(cut, i, span, line, h, s, limit)
    if best[0] == np.inf:
        return best
    if arc_of(cut.motion, i) >= 0:
        for end in span:  # an arc can come nearest at either end
            if phi(cut, i, end, line, h)[0] < best[0]:
                best = _descend(cut, i, span, line, h, end, limit)
    if not _level(cut.motion, i) or _has_valley(cut, i, span, line, h, best[2]):
        best = _lowest_of_parts(cut, i, span, line, h, best)
    return best


@njit_inlined()
def _level(motion, i):
    """Whether sweep i is a line, or an arc in a plane square to the tool axis.

    The distance from such an arc falls and rises once along it; from other arcs it may do so
    more often.
    """
    k, a = arc_of(motion, i), motion.arcs
    return k < 0 or (a[k, 1, 2] == 0.0 and a[k, 2, 2] == 0.0 and a[k, 3, 2] == 0.0)


@njit_part()
def _descend(cut, i, span, line, h, s, limit):
    """Newton's method on the derivative by s, kept in a bracket by its sign."""
    bend = 0.5 * bend_of(cut.motion, i)
    waves = bend * (span[1] - span[0]) ** 2 if arc_of(cut.motion, i) < 0 else np.inf
    low, high = span
    at_low, at_high = (np.nan, 0.0), (np.nan, 0.0)
    best_value, best_h, best_s = np.inf, 0.0, s
    again, was_before = False, False
    for turn in range(80):
        value, by_s, by_ss, by_h, _ = phi(cut, i, s, line, h)
        far = max(s - low, high - s)
        bound = value - max(by_s * (s - low), by_s * (s - high)) - bend * far * far
        if turn == 0 and bound > limit:
            return np.inf, 0.0, s
        above = value - best_value
        before = s > best_s  # the minimum lies before s
        if not above > 0.0:
            above, before = 0.0, by_s > 0.0
            best_value, best_h, best_s = value, by_h, s
        if before:
            high, at_high = s, (value, by_s)
            gain, step_end, fresh = by_s * (s - low), low, math.isnan(at_low[0])
        else:
            low, at_low = s, (value, by_s)
            gain, step_end, fresh = by_s * (s - high), high, math.isnan(at_high[0])
        if best_value + min(0.0, above - gain) - waves > limit:
            return np.inf, 0.0, best_s  # convex but for the waves: nowhere below that
        gain = max(0.0, gain) + bend * (high - low) ** 2
        if gain - above <= _ROOT_MM or high - low < 1e-13:
            break
        if by_ss > 0.0 and by_s * by_s < 0.1 * _ROOT_MM * by_ss:
            break
        step = -by_s / by_ss if by_ss > 0.0 else step_end - s
        if not low < s + step < high:
            step = step_end - s
            if not fresh:
                step = _between(low, at_low, high, at_high) - s
                step *= 8.0 if again else 1.0  # get past the kink, to close in from both sides
        s += step
        if (turn % 3 == 2 and not fresh) or not low <= s <= high:
            s = 0.5 * (low + high)
        again, was_before = before == was_before, before
    return best_value, best_h, best_s


@njit_inlined()
def _between(low, at_low, high, at_high):
    """Where the tangents at both ends of the bracket meet: at once at the tip of a kink."""
    s = (at_high[0] - at_low[0] + at_low[1] * low - at_high[1] * high) / (at_low[1] - at_high[1])
    return s if low < s < high else 0.5 * (low + high)


@njit_inlined()
def _has_valley(cut, i, span, line, h, s):
    """Whether phi is so level along s around its minimum that the displacement may ripple it."""
    width = span[1] - span[0]
    ripple = ripple_of(cut.motion, i)
    if ripple * width * width < _ROOT_MM:
        return False
    _, _, by_ss, _, curvature = phi(cut, i, s, line, h)
    if by_ss > 10.0 * ripple and curvature * _NEAR_MM < 0.1:
        return False
    for step in (-_VALLEY * width, _VALLEY * width):
        if span[0] < s + step < span[1]:
            by_s = phi(cut, i, s + step, line, h)[1]
            if abs(by_s) <= 2.0 * ripple * width or by_s * step < 0.0:
                return True
    return False


@njit_part()
def _lowest_of_parts(cut, i, span, line, h, best):
    """Look for a lower minimum in each part of the span that can have one."""
    width = (span[1] - span[0]) / _PARTS
    for part in range(_PARTS):
        piece = (span[0] + part * width, span[0] + (part + 1) * width)
        middle = 0.5 * (piece[0] + piece[1])
        other = _descend(cut, i, piece, line, h, middle, best[0])
        if other[0] < best[0]:
            best = other
    return best


@njit_part()
def entry(cut, i, span, line, most):
    """First h, going outwards from 0, at which the line is in the sweep's piece or touches it.

    Returns
    -------
    h, s : float
        h is -inf where the line's point at 0 is inside by more than `TOUCH_MM`; +inf where the
        sweep is not met up to `most`. A touch at 0 may come out as a tiny negative h.
    """
    straight = arc_of(cut.motion, i) < 0
    h, s, outside = 0.0, guess(cut, i, span, line, 0.0), 0.0
    for turn in range(300):
        distance, by_h, s = closest(cut, i, span, line, h, s, most - h + TOUCH_MM)
        if distance == np.inf:
            return np.inf, s
        if turn == 0 and distance < -TOUCH_MM:
            return -np.inf, s
        if abs(distance) <= TOUCH_MM and by_h > -_PARALLEL:
            if turn == 0:  # a touch at the start counts if it goes on
                begin = closest(cut, i, span, line, _PROBE_MM, s, TOUCH_MM)[0]
                h = h if begin <= TOUCH_MM else np.inf
            return h, s
        if abs(distance) <= (_ROOT_MM if turn > 0 else TOUCH_MM):
            return h - distance / by_h, s
        if 0.0 < distance < _NEAR_MM:
            on_rim, rim_h, rim_s = _meet_rim(cut, i, span, line, (h, s))
            if on_rim and closest(cut, i, span, line, rim_h, rim_s, most)[0] > -_ROUNDING_MM:
                return rim_h, rim_s
        if distance < 0.0:  # the displacement has bent the sweep: a step too far
            step = -distance / by_h if by_h < 0.0 else outside - h
            h = h + step if h + step > outside else 0.5 * (h + outside)
            continue
        outside = h
        if not straight and distance > _NEAR_MM:
            h += distance  # the nearest air is that far at least
        elif by_h < 0.0:
            h -= distance / by_h
        else:
            return np.inf, s
        if h > most + TOUCH_MM:  # a bent sweep may be met a little before that all the same
            if outside >= most + TOUCH_MM:
                return np.inf, s
            h = most + TOUCH_MM
    return h, s


@njit_part()
def _meet_rim(cut, i, span, line, near):
    """Solve for the h and s at which the line goes through a sharp rim of the moving tool.

    Right at a rim the gradient of the distance has no limit, so that the last steps have to be
    made on the rim's own two equations: radius and height are those of the corner.
    """
    h, s = near
    x, x1, _, d = _seen_from_tool(cut, i, s, line, h)
    rho = math.sqrt(x[0] * x[0] + x[1] * x[1])
    distance, gr, gz, curvature = signed_distance(cut.outlines, tool_of(cut.motion, i), rho, x[2])
    if distance <= 0.0 or abs(distance * curvature - 1.0) > 1e-6 or rho < _NEAR_MM:
        return False, h, s  # not opposite a sharp corner
    corner = (rho - gr * distance, x[2] - gz * distance)
    for _ in range(20):
        ex, ey = x[0] / rho, x[1] / rho
        off_r, off_z = rho - corner[0], x[2] - corner[1]
        if abs(off_r) + abs(off_z) < _ROOT_MM:
            return True, h, s
        r_h, r_s = ex * d[0] + ey * d[1], ex * x1[0] + ey * x1[1]
        det = r_h * x1[2] - r_s * d[2]
        if abs(det) < 1e-12:
            return False, h, s
        h -= (off_r * x1[2] - off_z * r_s) / det
        s -= (r_h * off_z - d[2] * off_r) / det
        if not (span[0] <= s <= span[1] and abs(h - near[0]) < 100.0 * distance + TOUCH_MM):
            return False, h, s
        x, x1, _, d = _seen_from_tool(cut, i, s, line, h)
        rho = max(math.sqrt(x[0] * x[0] + x[1] * x[1]), 1e-12)
    return False, h, s


@njit_part()
def exit_below(cut, i, span, line, h, least):
    """Where the line, followed inwards from h, leaves the sweep's piece.

    Returns
    -------
    h, s : float
        `least` where the sweep holds the line that far; +inf where it does not hold the
        line's point at h, or only touches it.
    touch : bool
        The sweep touches the line's point at h from outside: its own boundary is there.
    """
    s = guess(cut, i, span, line, h)
    distance, by_h, s = closest(cut, i, span, line, h, s, TOUCH_MM)
    if distance > TOUCH_MM:
        return np.inf, s, False
    if distance >= -TOUCH_MM:  # its body may begin right here
        begin = h - _PROBE_MM
        below, _, t = closest(cut, i, span, line, begin, s, -TOUCH_MM)
        if below >= -TOUCH_MM:
            return np.inf, s, by_h < -_PARALLEL
        h, s = begin, t
    for turn in range(100):
        lower = _exit_standing(cut, i, s, line, h, least)
        if lower <= least or h - lower < _ROOT_MM:
            return lower, s, False
        if turn > 2 and h - lower < _RIM_MM:  # slow: the exit is through a rim
            outside = closest(cut, i, span, line, lower - _RIM_MM, s, np.inf)[2]
            on_rim, rim_h, rim_s = _meet_rim(cut, i, span, line, (lower - _RIM_MM, outside))
            if on_rim and lower - _RIM_MM < rim_h < h:
                return rim_h, rim_s, False
        h = lower
        s = closest(cut, i, span, line, h, s, TOUCH_MM)[2]
    return h, s, False


@njit_inlined()
def _exit_standing(cut, i, s, line, h, least):
    """Where the line, from h inwards, leaves the convex tool that stands at s."""
    distance, _, _, by_h, _ = phi(cut, i, s, line, h)
    if distance >= -0.1 * _ROOT_MM:
        return h
    low = least
    if by_h < -0.1:
        low = max(least, h - distance / by_h)
    for _turn in range(100):
        distance, _, _, by_h, _ = phi(cut, i, s, line, low)
        if distance <= 0.1 * _ROOT_MM:
            return low
        step = -distance / by_h
        if by_h >= 0.0 or low + step >= h:
            return h
        if step < 1e-15:
            return low
        low += step
    return low
