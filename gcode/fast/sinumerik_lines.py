"""Plain motion of SINUMERIK obeyed by compiled code.

A line holds G0 to G3, G90, G91, M3 to M5, M7 to M9, axes, I J K, CR=, F, S, a block number and a
comment, each with a number; every other line is left to the reader.
"""

from __future__ import annotations

from gcode.fast.actions import (
    after_tool_change,
    coolant,
    letters_fit,
    move,
    set_feed,
    set_speed,
    spindle,
)
from gcode.fast.block_motion import COUNTER, are_signs_right, letters_of, motion_of
from gcode.fast.code_table import GROUPS
from gcode.fast.compiled import njit_kernel, njit_part
from gcode.fast.line_words import add_code, bit, clear_words
from gcode.fast.number_word import read_number

__all__ = ["obey_sinumerik_lines"]

_DISTANCE, _SPINDLE, _COOLANT = (GROUPS.index(n) for n in ("distance", "spindle", "coolant"))
_NEWLINE, _BLANK, _TAB, _RETURN, _SEMICOLON, _EQUAL = (ord(c) for c in "\n \t\r;=")
_A, _C, _G, _M, _N, _R, _Z = (ord(c) for c in "acgmnrz")
_F, _S = (ord(c) - _A for c in "fs")
_OF_F, _OF_S = bit("f"), bit("s")
_TAKEN = bit("xyzabcijkfs")
#: numbers below are written with 20 decimals for the interpreter, which may round them
_LEAST = 1e-4


@njit_part
def _read(data, at, w, codes):  # pragma: no cover - compiled
    """Read one line into WORDS; returns where the next begins, -1 where it is not understood."""
    clear_words(w)
    while True:
        c = data[at]
        if c == _NEWLINE:
            return at + 1
        if c in (_BLANK, _RETURN, _TAB):
            at += 1
            continue
        if c == _SEMICOLON:
            while data[at] != _NEWLINE:
                at += 1
            continue
        letter = c | 32
        if not _A <= letter <= _Z:
            return -1
        at += 1
        if letter == _N and w.content == 0 and 48 <= data[at] <= 57:
            while 48 <= data[at] <= 57:
                at += 1
            w.content = 1
            continue
        w.content = 1
        is_radius = letter == _C and data[at] | 32 == _R
        if is_radius:
            at += 1
            letter = _R
        while data[at] == _BLANK:
            at += 1
        is_equal = data[at] == _EQUAL
        if is_equal:
            at += 1
            while data[at] == _BLANK:
                at += 1
        value, decimals, at = read_number(data, at, False)
        if at < 0:
            return -1
        if letter in (_G, _M):
            if is_equal or decimals >= 0 or value < 0.0:
                return -1
            if not add_code(w, codes, 1 if letter == _M else 0, value):
                return -1
            continue
        flag = 1 << (letter - _A)
        if (is_radius and not is_equal) or (not is_radius and flag & _TAKEN == 0):
            return -1
        if w.seen & flag:
            return -1
        w.seen |= flag
        w.value[letter - _A] = value


@njit_part
def _obey(w, s, codes, out, feed_factor):  # pragma: no cover - compiled
    """Obey one block; tells whether that was possible."""
    if not w.seen and not w.g_count and not w.m_count:
        return True
    after_tool_change(s)
    motion = motion_of(w, s)
    if motion < -1 or motion > COUNTER or not are_signs_right(w):
        return False
    if not letters_fit(w.seen, w.letters | letters_of(codes, motion)):
        return False
    if w.seen & _OF_F:
        feed = w.value[_F]
        if feed_factor != 1.0:
            feed *= feed_factor
            if 0.0 < feed < _LEAST:
                return False
        set_feed(s, out, feed)
    if w.seen & _OF_S:
        set_speed(s, out, w.value[_S])
    if w.group[_SPINDLE] >= 0:
        spindle(s, out, w.group[_SPINDLE] // 10)
    if w.group[_COOLANT] >= 0:
        coolant(s, out, w.group[_COOLANT] // 10)
    if w.group[_DISTANCE] >= 0:
        s.absolute = 1 if w.group[_DISTANCE] == 900 else 0
    return motion < 0 or move(w, s, out, motion)


@njit_kernel
def obey_sinumerik_lines(
    data, at, line, state, kept, words, codes, out, feed_factor
):  # pragma: no cover - compiled
    """Obey lines from a byte offset on; arguments and result as those of `obey_lines`.

    `feed_factor` is the unit of F in program units.
    """
    s, w, size = state[0], words[0], data.shape[0]
    s.rows = s.arcs = s.dwells = s.events = s.wide = s.notes = s.is_full = 0
    while at < size:
        end = _read(data, at, w, codes)
        if end < 0:
            break
        if w.content:
            kept[0] = state[0]
            s.line = line + 1
            if not _obey(w, s, codes, out, feed_factor) or s.is_full:
                is_full = s.is_full
                state[0] = kept[0]
                s.is_full = is_full
                break
        at, line = end, line + 1
    s.line = line
    return at, line
