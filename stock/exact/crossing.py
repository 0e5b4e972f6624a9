"""Where a line comes into a piece of a sweep, and where it goes out.

Along a straight sweep psi is convex in h, so that Newton's method from outside never oversteps
the edge but by what the displacement bends; that is taken back. Along an arc the line is
followed by psi itself, which can skip nothing.

Source: closed form derived here: Newton's method on a convex function comes from outside without
overstepping its zero.
"""

from __future__ import annotations

import numpy as np

from stock.compiled import njit_inlined, njit_part
from stock.exact.descent import ROOT_MM
from stock.exact.meeting import TOUCH_MM
from stock.exact.motion import arc_of
from stock.exact.rim import meet_rim
from stock.exact.sweep_distance import start_of_search, sweep_distance
from stock.exact.tool_distance import tool_distance

__all__ = ["entry", "exit_below"]

#: rounding of a distance, mm
_ROUNDING_MM = 1e-12
#: going inwards, so near an edge that it should have been reached, mm
_RIM_MM = 1e-5
#: how far ahead along the line a touch is asked whether it is more than one, mm
_PROBE_MM = 1e-3
#: the line counts as nearly parallel to the surface that it touches below this cosine
_PARALLEL = 1e-4
#: nearer than this a rim may be met, and Newton steps are made towards arcs too, mm
_NEAR_MM = 1e-3
_MOST_TURNS_IN, _MOST_TURNS_OUT = 300, 100


@njit_part()
def entry(meeting, most):
    """First h, going outwards from 0, at which the line is in the sweep's piece or touches it.

    Parameters
    ----------
    meeting : Meeting
    most : float
        How far the line is of interest, mm.

    Returns
    -------
    h, s : float
        h is -inf where the line's point at 0 is inside by more than `TOUCH_MM`; +inf where the
        sweep is not met up to `most`. A touch at 0 may come out as a tiny negative h.
    """
    is_straight = arc_of(meeting.cut.motion, meeting.sweep) < 0
    h, outside, s = 0.0, 0.0, start_of_search(meeting, 0.0)
    for turn in range(_MOST_TURNS_IN):
        # asked at one place for all turns: twice the code takes the walk a seventh longer
        near = sweep_distance(meeting, h, s, most - h + TOUCH_MM)
        s = near.s
        if near.mm == np.inf:
            return np.inf, s
        if turn == 0 and near.mm < -TOUCH_MM:
            return -np.inf, s
        if abs(near.mm) <= TOUCH_MM and near.by_h > -_PARALLEL:
            if turn == 0:  # a touch at the start counts if it goes on
                ahead = sweep_distance(meeting, _PROBE_MM, s, TOUCH_MM)
                h = h if ahead.mm <= TOUCH_MM else np.inf
            return h, s
        if abs(near.mm) <= (ROOT_MM if turn > 0 else TOUCH_MM):
            return h - near.mm / near.by_h, s
        if 0.0 < near.mm < _NEAR_MM:
            is_met, rim_h, rim_s = meet_rim(meeting, h, s)
            if is_met and sweep_distance(meeting, rim_h, rim_s, most).mm > -_ROUNDING_MM:
                return rim_h, rim_s
        h, outside = _next_h(h, outside, near, is_straight)
        if h > most + TOUCH_MM:  # a bent sweep may be met a little before that all the same
            if h == np.inf or outside >= most + TOUCH_MM:
                return np.inf, s
            h = most + TOUCH_MM
    return h, s


@njit_inlined()
def _next_h(h, outside, near, is_straight):
    """Where to look next, inf for nowhere, and the farthest h that is known to be outside."""
    if near.mm < 0.0:  # the displacement has bent the sweep: a step too far
        step = -near.mm / near.by_h if near.by_h < 0.0 else outside - h
        return (h + step if h + step > outside else 0.5 * (h + outside)), outside
    if not is_straight and near.mm > _NEAR_MM:
        return h + near.mm, h  # the nearest air is that far at least
    return (h - near.mm / near.by_h if near.by_h < 0.0 else np.inf), h


@njit_part()
def exit_below(meeting, h, least):
    """Where the line, followed inwards from h, leaves the sweep's piece.

    Parameters
    ----------
    meeting : Meeting
    h : float
    least : float
        How far the line is of interest, mm.

    Returns
    -------
    h, s : float
        `least` where the sweep holds the line that far; +inf where it does not hold the
        line's point at h, or only touches it.
    is_touch : bool
        The sweep touches the line's point at h from outside: its own boundary is there.
    """
    near = sweep_distance(meeting, h, start_of_search(meeting, h), TOUCH_MM)
    if near.mm > TOUCH_MM:
        return np.inf, near.s, False
    s = near.s
    if near.mm >= -TOUCH_MM:  # its body may begin right here
        h -= _PROBE_MM
        below = sweep_distance(meeting, h, s, -TOUCH_MM)
        if below.mm >= -TOUCH_MM:
            return np.inf, s, near.by_h < -_PARALLEL
        s = below.s
    for turn in range(_MOST_TURNS_OUT):
        lower = _exit_of_tool(meeting, h, s, least)
        if lower <= least or h - lower < ROOT_MM:
            return lower, s, False
        if turn > 2 and h - lower < _RIM_MM:  # slow: the exit is through a rim
            outside = lower - _RIM_MM
            at = sweep_distance(meeting, outside, s, np.inf).s
            is_met, rim_h, rim_s = meet_rim(meeting, outside, at)
            if is_met and outside < rim_h < h:
                return rim_h, rim_s, False
        h = lower  # out of the tool that stands at s: is there one that holds this place too?
        s = sweep_distance(meeting, h, s, TOUCH_MM).s
    return h, s, False


@njit_inlined()
def _exit_of_tool(meeting, h, s, least):
    """Where the line, from h inwards, leaves the convex tool that stands at s."""
    at = tool_distance(meeting, h, s)
    if at.mm >= -0.1 * ROOT_MM:
        return h
    low = least
    if at.by_h < -0.1:
        low = max(least, h - at.mm / at.by_h)
    for _ in range(_MOST_TURNS_OUT):
        at = tool_distance(meeting, low, s)
        if at.mm <= 0.1 * ROOT_MM:
            return low
        step = -at.mm / at.by_h
        if at.by_h >= 0.0 or low + step >= h:
            return h
        if step < 1e-15:
            return low
        low += step
    return low
