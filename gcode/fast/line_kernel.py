"""Lines of RS274/NGC and of Fanuc's language obeyed by compiled code.

It obeys line after line as long as it understands every character and every word, and stops
before the first line that it does not; the interpreter takes that one. It makes the same
operations in the same order as the interpreter, so both give the same bits.
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
    pause,
    select_plane,
    select_system,
    select_tool,
    set_feed,
    set_path_control,
    set_speed,
    set_tool_length,
    spindle,
)
from gcode.fast.block_motion import CANCEL, COUNTER, are_signs_right, letters_of, motion_of
from gcode.fast.code_table import GROUPS
from gcode.fast.compiled import njit_kernel, njit_part
from gcode.fast.cycles import canned_cycle
from gcode.fast.fanuc_blocks import obey_fanuc
from gcode.fast.lane_output import write_event, write_note
from gcode.fast.line_words import bit, read_line
from gcode.state.stretch_events import EVENT_NAMES

__all__ = ["obey_lines"]

_COMMENT = EVENT_NAMES.index("comment")
(_NONMODAL, _MOTION, _PLANE, _DISTANCE, _ARC_DISTANCE, _FEED_MODE, _UNITS, _COMPENSATION,
 _TOOL_LENGTH, _RETRACT, _SYSTEM, _CONTROL, _TOOL_CHANGE, _SPINDLE, _COOLANT,
 _STOP) = range(len(GROUPS))  # fmt: skip
_F, _H, _L, _P, _S, _T = (ord(letter) - ord("a") for letter in "fhlpst")
_OF_F, _OF_H, _OF_P, _OF_S, _OF_T = (bit(letter) for letter in "fhpst")
_AXES, _PLACE, _IJK, _ARC_WORDS = bit("xyzabc"), bit("xyz"), bit("ijk"), bit("ijkpr")


@njit_part
def _is_cycle(codes, motion):  # pragma: no cover - compiled
    return motion > COUNTER and motion != CANCEL and codes.group[0, motion] == _MOTION


@njit_part
def _obey_motion(w, s, codes, out, motion):  # pragma: no cover - compiled
    if motion == CANCEL:
        s.cycle_initial = np.nan
        s.motion = CANCEL
        return True
    if _is_cycle(codes, motion):
        return canned_cycle(w, s, out, motion)
    return motion <= COUNTER and move(w, s, out, motion)


@njit_part
def _obey_rs274(w, s, codes, frames, out):  # pragma: no cover - compiled
    """Obey one block of RS274/NGC; tells whether that was possible."""
    after_tool_change(s)
    motion = motion_of(w, s)
    if motion < -1 or not are_signs_right(w):
        return False
    if not letters_fit(w.seen, w.letters | letters_of(codes, motion)):
        return False
    pauses = w.group[_NONMODAL] >= 0
    if pauses and (motion >= 0 or not w.seen & _OF_P or w.value[_P] < 0.0):
        return False
    if w.comment >= 0:
        write_event(s, out, _COMMENT, w.comment)
    if not _obey_words(w, s, frames, out):
        return False
    if pauses:
        pause(s, out, w.value[_P])
    return _obey_modes(w, s, frames, out) and (motion < 0 or _obey_motion(w, s, codes, out, motion))


@njit_part
def _obey_words(w, s, frames, out):  # pragma: no cover - compiled
    """Feed mode, F, S, T and M codes."""
    if w.group[_FEED_MODE] >= 0:
        feed_per_minute(s, out)
    if w.seen & _OF_F:
        set_feed(s, out, w.value[_F])
    if w.seen & _OF_S:
        set_speed(s, out, w.value[_S])
    if w.seen & _OF_T and not select_tool(s, frames, w.value[_T]):
        return False
    if w.group[_TOOL_CHANGE] >= 0 and not change_tool(s, out):
        return False
    if w.group[_SPINDLE] >= 0:
        spindle(s, out, w.group[_SPINDLE] // 10)
    if w.group[_COOLANT] >= 0:
        coolant(s, out, w.group[_COOLANT] // 10)
    return True


@njit_part
def _obey_modes(w, s, frames, out):  # pragma: no cover - compiled
    """Plane, tool length, work system, path control, distance and retract modes."""
    if w.group[_PLANE] >= 0:
        select_plane(s, out, w.group[_PLANE])
    if w.group[_UNITS] >= 0 and (w.group[_UNITS] == 200) != (s.unit_mm == 25.4):
        return False
    if w.group[_TOOL_LENGTH] >= 0 and not _tool_length(w, s, frames, out):
        return False
    if w.group[_SYSTEM] >= 0:
        tenths = w.group[_SYSTEM]
        select_system(s, frames, out, tenths // 10 - 53 + tenths % 10)
    if w.group[_CONTROL] >= 0:
        tolerance = w.value[_P] if w.group[_CONTROL] == 640 and w.seen & _OF_P else 0.0
        set_path_control(s, out, w.group[_CONTROL], tolerance)
    if w.group[_DISTANCE] >= 0:
        s.absolute = 1 if w.group[_DISTANCE] == 900 else 0
    if w.group[_ARC_DISTANCE] >= 0:
        s.arc_absolute = 1 if w.group[_ARC_DISTANCE] == 901 else 0
    if w.group[_RETRACT] >= 0:
        s.retract_to_initial = 1 if w.group[_RETRACT] == 980 else 0
    if w.group[_STOP] >= 0:
        write_note(s, out, w.group[_STOP])
    return True


@njit_part
def _tool_length(w, s, frames, out):  # pragma: no cover - compiled
    if w.group[_TOOL_LENGTH] == 490:
        return set_tool_length(s, frames, out, -1)
    number = s.tool if s.refresh and s.tool else s.loaded
    if w.seen & _OF_H:
        if w.value[_H] != math.floor(w.value[_H]):
            return False
        number = np.int64(w.value[_H])
    return set_tool_length(s, frames, out, number)


@njit_kernel
def obey_lines(
    data, at, line, state, kept, words, codes, frames, out, each_word
):  # pragma: no cover - compiled
    """Obey lines from a byte offset on.

    Parameters
    ----------
    data : (bytes,) uint8
        The program, ending with a newline.
    at : int
        Offset of the first byte of a line.
    line : int
        0-based number of that line.
    state : (1,) STATE
        Changed in place; `is_full` says that there was no more room in `out`.
    kept : (1,) STATE
        Room.
    words : (1,) WORDS
        Room.
    codes : CodeTable
    frames : Frames
    out : Output
    each_word : int or None
        None for RS274/NGC, else every word is obeyed for itself, as Fanuc's are.

    Returns
    -------
    tuple of int
        Offset and 0-based number of the first line that was not obeyed.
    """
    s, w, size = state[0], words[0], data.shape[0]
    s.rows = s.arcs = s.dwells = s.events = s.wide = s.notes = s.is_full = 0
    while at < size:
        end = read_line(data, at, w, codes)
        if end < 0:
            break
        if w.content:
            kept[0] = state[0]
            s.line = line + 1
            if each_word is None:
                obeyed = _obey_rs274(w, s, codes, frames, out)
            else:
                obeyed = obey_fanuc(w, s, codes, frames, out)
            if not obeyed or s.is_full:
                is_full = s.is_full
                state[0] = kept[0]
                s.is_full = is_full
                break
        at, line = end, line + 1
    s.line = line
    return at, line
