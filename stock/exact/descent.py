"""Down into one valley of phi(h, s) along s, by Newton's method in a bracket.

From the tangent at s, phi can fall no farther than by what it bends: `bend_of` bounds that. So
the search knows how much lower the minimum can be than the lowest value so far. It ends once that
is nothing, or once the tool is sure to stay farther off than the caller cares.

Source: closed form derived here: Newton's method kept in a bracket; a bound of the second
derivative bounds the fall.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from stock.compiled import njit_inlined, njit_part
from stock.exact.motion import arc_of, bend_of
from stock.exact.tool_distance import tool_distance

__all__ = ["ROOT_MM", "Nearest", "descend"]

#: a root or a minimum is found when no more than this is missing, mm: the rounding of coordinates
ROOT_MM = 2e-13
#: a bracket without length
_NO_LENGTH = 1e-13
_MOST_TURNS = 80


class Nearest(NamedTuple):
    """Where the tool comes nearest to a point of the line.

    Attributes
    ----------
    mm : float
        The distance there; inf where it is above the limit for sure.
    by_h : float
        Its derivative along the line.
    s : float
        The place on the sweep.
    """

    mm: float
    by_h: float
    s: float


class _End(NamedTuple):
    """An end of the bracket: the distance there, nan if not looked at, and its slope."""

    s: float
    mm: float
    by_s: float


@njit_part()
def descend(meeting, h, s, limit):
    """The minimum of phi(h, .) on the piece, in the valley in which s lies.

    Parameters
    ----------
    meeting : Meeting
    h : float
    s : float
        Where to start.
    limit : float
        A bound above which the minimum is of no interest, mm.

    Returns
    -------
    Nearest
    """
    low, high = _End(meeting.span[0], np.nan, 0.0), _End(meeting.span[1], np.nan, 0.0)
    motion, length = meeting.cut.motion, meeting.span[1] - meeting.span[0]
    bend = 0.5 * bend_of(motion, meeting.sweep)
    waves = bend * length**2 if arc_of(motion, meeting.sweep) < 0 else np.inf
    best = Nearest(np.inf, 0.0, s)
    again, was_before = False, False
    for turn in range(_MOST_TURNS):
        here = tool_distance(meeting, h, s)
        if turn == 0 and _least_on_piece(meeting.span, s, here, bend) > limit:
            return Nearest(np.inf, 0.0, s)
        above, before = here.mm - best.mm, s > best.s  # the minimum lies before s
        if not above > 0.0:
            above, before = 0.0, here.by_s > 0.0
            best = Nearest(here.mm, here.by_h, s)
        end = _End(s, here.mm, here.by_s)
        if before:
            other, high = low, end
        else:
            other, low = high, end
        fall = here.by_s * (s - other.s)  # of the tangent, up to the other end
        if best.mm + min(0.0, above - fall) - waves > limit:
            return Nearest(np.inf, 0.0, best.s)  # convex but for the waves: nowhere below that
        missing = max(0.0, fall) + bend * (high.s - low.s) ** 2 - above
        if missing <= ROOT_MM or high.s - low.s < _NO_LENGTH or _is_bottom(here):
            break
        again, was_before = before == was_before, before
        s = _next_s((low, high), s, here, (before, again, turn % 3 == 2))
    return best


@njit_inlined()
def _least_on_piece(span, s, here, bend):
    """What the tangent at s and the bend leave possible anywhere on the piece."""
    far = max(s - span[0], span[1] - s)
    fall = max(here.by_s * (s - span[0]), here.by_s * (s - span[1]))
    return here.mm - fall - bend * far * far


@njit_inlined()
def _is_bottom(here):
    """Whether Newton's parabola has its lowest point as low as here."""
    return here.by_ss > 0.0 and here.by_s * here.by_s < 0.1 * ROOT_MM * here.by_ss


@njit_inlined()
def _next_s(bracket, s, here, state):
    """Newton's step; where it leaves the bracket, a place that makes the bracket shorter."""
    (low, high), (before, again, halve) = bracket, state
    other = low if before else high
    # a step towards an end that has been seen must not land there: a rounding away from it,
    # which side of it is lower is a matter of rounding, and the wrong side may be kept
    newton = s - here.by_s / here.by_ss if here.by_ss > 0.0 else np.inf
    is_inside = low.s < newton < high.s
    if math.isnan(other.mm):
        return newton if is_inside else other.s
    middle = 0.5 * (low.s + high.s)
    if halve:
        return middle
    if is_inside:
        return newton
    way = _where_tangents_meet(low, high) - s
    s += 8.0 * way if again else way  # get past the kink, to close in from both sides
    return s if low.s <= s <= high.s else middle


@njit_inlined()
def _where_tangents_meet(low, high):
    """Where the tangents at both ends of the bracket meet: at once at the tip of a kink."""
    s = (high.mm - low.mm + low.by_s * low.s - high.by_s * high.s) / (low.by_s - high.by_s)
    return s if low.s < s < high.s else 0.5 * (low.s + high.s)
