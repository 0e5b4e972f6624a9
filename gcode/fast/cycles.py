"""Canned cycles of RS274/NGC in compiled code: the counterpart of `gcode.motion.cycles`."""

from __future__ import annotations

import math

import numpy as np

from gcode.fast.actions import go, pause
from gcode.fast.compiled import njit_part
from gcode.fast.line_words import bit
from gcode.state.record import Call

__all__ = ["canned_cycle"]

_TRAVERSE, _FEED = int(Call.TRAVERSE), int(Call.FEED)
_D, _L, _P, _Q, _R, _X = (ord(letter) - ord("a") for letter in "dlpqrx")
_ROTARY = bit("abc")
#: clearance above the last depth in G73 and G83, mm
_PECK_CLEARANCE_MM = 0.254
#: more pecks than this are left to the interpreter, which may refuse them
_MOST_PECKS = 10_000
_LEFT_TAP, _RIGHT_TAP, _PECKING = 740, 840, (730, 830)


@njit_part
def _said(w, letter):  # pragma: no cover - compiled
    return w.seen & (1 << letter) != 0


@njit_part
def _rapid_or_feed(s, out, call, axial, level):  # pragma: no cover - compiled
    s.position[axial] = level
    go(s, out, call)


@njit_part
def _remember(w, s, motion, axial):  # pragma: no cover - compiled
    """Take R, depth, P and Q from the block; tells whether all are there."""
    fresh = s.motion != motion
    if fresh and not (_said(w, _R) and _said(w, _X + axial)):
        return False
    if fresh and motion in _PECKING and not _said(w, _Q):
        return False
    if fresh and (motion == 820 or motion == 890) and not _said(w, _P):
        return False
    s.cycle_r = w.value[_R] if _said(w, _R) else s.cycle_r
    s.cycle_bottom = w.value[_X + axial] if _said(w, _X + axial) else s.cycle_bottom
    s.cycle_p = w.value[_P] if _said(w, _P) else s.cycle_p
    s.cycle_q = w.value[_Q] if _said(w, _Q) else s.cycle_q
    return not (motion in _PECKING and s.cycle_q <= 0.0)


@njit_part
def canned_cycle(w, s, out, motion):  # pragma: no cover - compiled
    """G73, G74, G81 to G85, G89 by ten times their numbers; tells whether it was obeyed."""
    first = 0 if s.plane == 1 else 1 if s.plane == 2 else 2
    second, axial = (first + 1) % 3, (first + 2) % 3
    repeats = w.value[_L] if _said(w, _L) else 1.0
    if s.feed == 0.0 or w.seen & _ROTARY or repeats != math.floor(repeats) or repeats < 1.0:
        return False
    tapping = motion in (_LEFT_TAP, _RIGHT_TAP)
    if tapping and (s.plane != 1 or s.spindle != (1 if motion == _RIGHT_TAP else -1)):
        return False
    if not _remember(w, s, motion, axial):
        return False
    if np.isnan(s.cycle_initial):
        s.cycle_initial = s.position[axial]
    r, bottom, old, level = s.cycle_r, s.cycle_bottom, s.cycle_initial, s.position[axial]
    x, y, step_x, step_y = s.position[first], s.position[second], 0.0, 0.0
    word_x = w.value[_X + first] if _said(w, _X + first) else 0.0
    word_y = w.value[_X + second] if _said(w, _X + second) else 0.0
    if s.absolute:
        x = word_x if _said(w, _X + first) else x
        y = word_y if _said(w, _X + second) else y
    else:
        r = r + old
        bottom = r + bottom
        step_x, step_y = word_x, word_y
    if r < bottom:
        return False
    if old < r:
        _rapid_or_feed(s, out, _TRAVERSE, axial, r)
        old = level = r
    clear = old if s.retract_to_initial else r
    clearance = w.value[_D] if _said(w, _D) else _PECK_CLEARANCE_MM / s.unit_mm
    for repeat in range(np.int64(repeats)):
        x, y = x + step_x, y + step_y
        s.position[first], s.position[second] = x, y
        above = level if repeat == 0 and level > r else clear
        _rapid_or_feed(s, out, _TRAVERSE, axial, above)
        if above > r:
            _rapid_or_feed(s, out, _TRAVERSE, axial, r)
        if not _hole(s, out, motion, axial, r, bottom, clear, clearance):
            return False
        if s.is_full:
            return False
    s.motion = motion
    return True


@njit_part
def _hole(s, out, motion, axial, r, bottom, clear, clearance):  # pragma: no cover - compiled
    """From the clearance plane down and out; tells whether it was obeyed."""
    if motion in _PECKING:
        if (r - bottom) / s.cycle_q > _MOST_PECKS:
            return False
        depth = r - s.cycle_q
        while depth > bottom:
            _rapid_or_feed(s, out, _FEED, axial, depth)
            if motion == 830:
                _rapid_or_feed(s, out, _TRAVERSE, axial, r)
            _rapid_or_feed(s, out, _TRAVERSE, axial, depth + clearance)
            depth -= s.cycle_q
    _rapid_or_feed(s, out, _FEED, axial, bottom)
    if motion == 820 or motion == 890 or motion in (_LEFT_TAP, _RIGHT_TAP):
        pause(s, out, s.cycle_p)
    if motion == 850:
        _rapid_or_feed(s, out, _FEED, axial, r)
    feeds_out = motion == 890 or motion in (_LEFT_TAP, _RIGHT_TAP)
    _rapid_or_feed(s, out, _FEED if feeds_out else _TRAVERSE, axial, clear)
    return True
