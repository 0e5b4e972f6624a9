"""Blocks of Fanuc's language in compiled code: every word is obeyed for itself, in a fixed order.

The counterpart of `gcode.dialects.fanuc.blocks` and `offset_words`.
"""

from __future__ import annotations

import math

import numpy as np

from gcode.fast.actions import (
    after_tool_change,
    change_tool,
    coolant,
    feed_per_minute,
    letters_fit,
    move,
    select_plane,
    select_system,
    select_tool,
    set_feed,
    set_speed,
    set_tool_length,
    spindle,
)
from gcode.fast.code_table import GROUPS
from gcode.fast.compiled import njit_part
from gcode.fast.fanuc_cycles import fanuc_cycle
from gcode.fast.lane_output import write_note
from gcode.fast.line_words import bit

__all__ = ["obey_fanuc"]

(_MOTION, _PLANE, _DISTANCE, _FEED_MODE, _UNITS, _TOOL_LENGTH, _RETRACT, _SYSTEM) = (
    GROUPS.index(name) for name in ("motion", "plane", "distance", "feed_mode", "units",
                                    "tool_length", "retract", "system"))  # fmt: skip
_F, _H, _S, _T, _X = (ord(letter) - ord("a") for letter in "fhstx")
_OF_F, _OF_H, _OF_K, _OF_P, _OF_S, _OF_T, _OF_D = (bit(letter) for letter in "fhkpstd")
_TAKEN, _PLACE, _AXES, _IJK = bit("fhst"), bit("xyz"), bit("xyzabc"), bit("ijk")
_MOVING, _ARC_END = bit("xyzabcijkr"), bit("xyzijkr")
_LENGTHS, _ANGLES = bit("xyzijkrq"), bit("abc")
_CANCEL, _CLOCKWISE, _COUNTER = 800, 20, 30
#: six digits are written of S, and F is not written in less than 1e-4
_LARGEST_SPEED, _LEAST_FEED = 999_999.0, 1e-4


@njit_part
def _count_increments(w, s):  # pragma: no cover - compiled
    """Numbers without a point in the increments of the control; False where that has to be told."""
    pointless, code = w.pointless & (_LENGTHS | _ANGLES), w.group[_MOTION]
    if (code < 0 and s.cycle) or (code > _COUNTER and code != _CANCEL):
        pointless &= ~_OF_K  # how often
    for letter in range(26 if pointless else 0):
        flag = 1 << letter
        if pointless & flag:
            if not s.takes_pointless and w.value[letter] != 0.0:
                return False
            w.value[letter] *= s.degree_increment if flag & _ANGLES else s.increment
    return True


@njit_part
def obey_fanuc(w, s, codes, frames, out):  # pragma: no cover - compiled
    """Obey one block; tells whether that was possible."""
    if not w.seen and not w.m_count and not w.g_count:
        return True
    if w.seen & _OF_D or not _count_increments(w, s) or not _words_before(w, s, frames, out):
        return False
    if not _frames(w, s, frames, out) or not _tool_length(w, s, frames, out):
        return False
    if not _motion(w, s, codes, out):
        return False
    for index in range(w.m_count):
        code = w.m[index]
        if code in (0, 1, 5, 9):
            after_tool_change(s)
            if code == 5:
                spindle(s, out, code)
            elif code == 9:
                coolant(s, out, code)
            else:
                write_note(s, out, 10 * code)
    return True


@njit_part
def _words_before(w, s, frames, out):  # pragma: no cover - compiled
    """T, S and the M codes that act before the motion."""
    if w.seen & _OF_T:
        after_tool_change(s)
        if not select_tool(s, frames, w.value[_T]):
            return False
    if w.seen & _OF_S:
        speed = w.value[_S]
        if speed != math.floor(speed) or not 0.0 <= speed <= _LARGEST_SPEED:
            return False
        after_tool_change(s)
        set_speed(s, out, speed)
    for index in range(w.m_count):
        code = w.m[index]
        if code in (3, 4, 6, 7, 8):
            after_tool_change(s)
            if code == 6:
                if not change_tool(s, out):
                    return False
            elif code < 6:
                spindle(s, out, code)
            else:
                coolant(s, out, code)
    return True


@njit_part
def _frames(w, s, frames, out):  # pragma: no cover - compiled
    """Units, plane, distances, feed mode, retraction, work system and feed."""
    for group in (_UNITS, _PLANE, _DISTANCE, _FEED_MODE, _RETRACT, _SYSTEM):
        if w.group[group] >= 0:
            after_tool_change(s)
    if w.group[_UNITS] >= 0 and (w.group[_UNITS] == 200) != (s.unit_mm == 25.4):
        return False
    if w.group[_PLANE] >= 0:
        select_plane(s, out, w.group[_PLANE])
    if w.group[_DISTANCE] >= 0:
        s.absolute = 1 if w.group[_DISTANCE] == 900 else 0
    if w.group[_FEED_MODE] >= 0:
        feed_per_minute(s, out)
    if w.group[_RETRACT] >= 0:
        s.retract_to_initial = 1 if w.group[_RETRACT] == 980 else 0
    if w.group[_SYSTEM] >= 0:
        if w.group[_SYSTEM] == 540 and w.seen & _OF_P:
            return False
        select_system(s, frames, out, w.group[_SYSTEM] // 10 - 53)
    if w.seen & _OF_F:
        feed = w.value[_F]
        if feed < _LEAST_FEED and feed != 0.0:
            return False
        after_tool_change(s)
        set_feed(s, out, feed)
    return True


@njit_part
def _tool_length(w, s, frames, out):  # pragma: no cover - compiled
    """G43, G49 and H."""
    code, said = w.group[_TOOL_LENGTH], w.seen & _OF_H != 0
    if said:
        s.h = w.value[_H]
    if code >= 0:
        s.length_sign = 1 if code == 430 else 0
    if code < 0 and not (said and s.length_sign):
        return True
    number = 0.0 if np.isnan(s.h) else s.h
    if number != math.floor(number) or number < 0.0 or s.length_sign < 0:
        return False
    before = (s.position[0], s.position[1], s.position[2])
    after_tool_change(s)
    chosen = np.int64(number) if s.length_sign and number else -1
    if not set_tool_length(s, frames, out, chosen):
        return False
    if not s.absolute:
        for axis in range(3):
            w.value[_X + axis] += before[axis] - s.position[axis]
    return True


@njit_part
def _motion(w, s, codes, out):  # pragma: no cover - compiled
    code, left = w.group[_MOTION], w.seen & ~_TAKEN
    if code > _COUNTER and code != _CANCEL:
        return fanuc_cycle(w, s, out, code, left)
    if code < 0 and s.cycle:
        return fanuc_cycle(w, s, out, s.cycle, left)
    if code >= 0:
        s.cycle = 0
    if code == _CANCEL:
        s.motion = _CANCEL
        if not left & _PLACE:
            return left == 0
        code = 0
    if code < 0 and left == 0:
        return True
    if code < 0 and not left & _MOVING:
        return False
    if code < 0 and (s.motion < 0 or s.motion == _CANCEL):
        s.motion = 0
    if (code in (_CLOCKWISE, _COUNTER)) and not left & _ARC_END:
        s.motion = code
        return left == 0
    return _interpolate(w, s, codes, out, code, left)


@njit_part
def _interpolate(w, s, codes, out, code, left):  # pragma: no cover - compiled
    """G0 to G3, said or in force."""
    motion = code
    if code < 0:
        centred = (s.motion == _CLOCKWISE or s.motion == _COUNTER) and left & _IJK
        if not (left & _AXES or centred):
            return False
        motion = s.motion
    if motion > _COUNTER or not letters_fit(left, codes.letters[0, motion]):
        return False
    after_tool_change(s)
    return move(w, s, out, motion)
