"""Drilling cycles of Fanuc and Haas in compiled code.

The counterpart of `gcode.dialects.fanuc.cycles`.
"""

from __future__ import annotations

import math

import numpy as np

from gcode.fast.actions import go, pause
from gcode.fast.compiled import njit_part
from gcode.fast.line_words import bit
from gcode.state.record import Call

__all__ = ["fanuc_cycle"]

_TRAVERSE, _FEED = int(Call.TRAVERSE), int(Call.FEED)
_K, _L, _P, _Q, _R, _X = (ord(letter) - ord("a") for letter in "klpqrx")
_OF_K, _OF_L, _OF_P, _OF_Q, _OF_R, _PLACE = (bit(w) for w in ("k", "l", "p", "q", "r", "xyz"))
_KNOWN = bit("xyzrpqkl")
#: more pecks than this are left to the interpreter, which may refuse them
_MOST_PECKS = 10_000
_LEAST = 1e-9
#: what a transformation that changes nothing makes of -0.0
_NO_MINUS_ZERO = 0.0
_CHIPS, _TAP, _DEEP, _BORING, _BORING_WITH_DWELL, _WITH_DWELL = 730, 840, 830, 850, 890, 820


@njit_part
def fanuc_cycle(w, s, out, code, left):  # pragma: no cover - compiled
    """A block with a cycle, said or in force, by ten times its number; tells whether it was obeyed.

    `left` has the bits of the letters that are not spoken for.
    """
    first = 0 if s.plane == 1 else 1 if s.plane == 2 else 2
    second, axial = (first + 1) % 3, (first + 2) % 3
    if left & ~_KNOWN or (left & _OF_K and not s.repeats_in_k):
        return False
    if not s.cycle:
        s.cycle_initial = s.position[axial]
        s.cycle_r = s.cycle_bottom = s.cycle_q = np.nan
        s.cycle_p = 0.0
    s.cycle = s.motion = code
    new_levels = _take(w, s, axial)
    repeats = w.value[_K] if left & _OF_K else w.value[_L] if left & _OF_L else 1.0
    if repeats != math.floor(repeats) or repeats < 0.0:
        return False
    if not left & _PLACE and not new_levels:
        return True
    if np.isnan(s.cycle_bottom) or s.feed == 0.0:
        return False
    if np.isnan(s.cycle_r):
        s.cycle_r = s.cycle_initial
    for _ in range(np.int64(repeats)):
        for axis in (first, second):
            word = w.value[_X + axis] if left & (1 << (_X + axis)) else 0.0
            if not s.absolute:
                s.position[axis] = s.position[axis] + word
            elif left & (1 << (_X + axis)):
                s.position[axis] = word
            s.position[axis] += _NO_MINUS_ZERO
        go(s, out, _TRAVERSE)
        if not _hole(s, out, code, axial) or s.is_full:
            return False
    return True


@njit_part
def _take(w, s, axial):  # pragma: no cover - compiled
    """R, depth, P and Q of the block; tells whether it has levels."""
    of_depth = 1 << (_X + axial)
    if w.seen & _OF_R:
        s.cycle_r = w.value[_R] if s.absolute else s.cycle_initial + w.value[_R]
    if w.seen & of_depth:
        above = s.cycle_initial if np.isnan(s.cycle_r) else s.cycle_r
        depth = w.value[_X + axial]
        s.cycle_bottom = depth if s.absolute else above + depth
    if w.seen & _OF_P:
        in_seconds = s.pointed_p_is_seconds and not w.pointless & _OF_P
        s.cycle_p = w.value[_P] * (1.0 if in_seconds else s.dwell_p_s)
    if w.seen & _OF_Q:
        s.cycle_q = w.value[_Q]
    return w.seen & (_OF_R | of_depth) != 0


@njit_part
def _to(s, out, call, axial, level):  # pragma: no cover - compiled
    s.position[axial] = level + _NO_MINUS_ZERO
    go(s, out, call)


@njit_part
def _dwell(s, out):  # pragma: no cover - compiled
    if s.cycle_p != 0.0:
        pause(s, out, s.cycle_p)


@njit_part
def _pecks(s, out, code, axial, clearance):  # pragma: no cover - compiled
    """The pecks but the last; tells whether they are few enough."""
    r, bottom, q = s.cycle_r, s.cycle_bottom, 0.0 if np.isnan(s.cycle_q) else abs(s.cycle_q)
    if q == 0.0:
        return code == _TAP
    down, count = 1.0 if bottom > r else -1.0, abs(bottom - r) / q
    if count > _MOST_PECKS:
        return False
    for peck in range(1, np.int64(count) + 1):
        depth = r + down * q * peck
        if (bottom - depth) * down > _LEAST:
            _to(s, out, _FEED, axial, depth)
            if code != _CHIPS:
                _to(s, out, _FEED if code == _TAP else _TRAVERSE, axial, r)
            _to(s, out, _FEED if code == _TAP else _TRAVERSE, axial, depth + clearance)
    return True


@njit_part
def _hole(s, out, code, axial):  # pragma: no cover - compiled
    """From above the hole to R, down and out; tells whether it was obeyed."""
    r, bottom = s.cycle_r, s.cycle_bottom
    _to(s, out, _TRAVERSE, axial, r)
    clearance = s.peck_clearance if bottom < r else -s.peck_clearance
    if code in (_CHIPS, _DEEP, _TAP) and not _pecks(s, out, code, axial, clearance):
        return False
    _to(s, out, _FEED, axial, bottom)
    if code in (_CHIPS, _DEEP, _TAP, _WITH_DWELL, _BORING_WITH_DWELL):
        _dwell(s, out)
    if code in (_TAP, _BORING, _BORING_WITH_DWELL):
        _to(s, out, _FEED, axial, r)
    _to(s, out, _TRAVERSE, axial, s.cycle_initial if s.retract_to_initial else r)
    return True
