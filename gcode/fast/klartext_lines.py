"""Plain motion of HEIDENHAIN's Klartext obeyed by compiled code.

A line is L, C, CR or CC with X Y Z, IX IY IZ, F, FMAX, FAUTO, R0, DR, M3 to M5, M7 to M9, M13 and
M14, a block number and a comment; every other line is left to the reader. What the reader hands to
the interpreter as text is made here in the same order.
"""

from __future__ import annotations

import numpy as np

from gcode.fast.actions import after_tool_change, coolant, move, set_feed, spindle
from gcode.fast.compiled import njit_kernel, njit_part
from gcode.fast.line_words import MOST_M, bit
from gcode.fast.number_word import read_number

__all__ = ["ARC", "BLOCK", "KLARTEXT", "LINE", "NO_PIECE", "RADIUS", "obey_klartext_lines"]

#: what a line says
BLOCK = np.dtype([
    ("head", "i8"),
    ("value", "f8", 3), ("said", "i8"), ("incremental", "i8"),  # X Y Z; a bit for each axis
    ("radius", "f8"), ("feed", "f8"),  # NaN for none
    ("sense", "i8"),  # DR: 1 counter-clockwise, -1 clockwise, 0 for none
    ("rapid", "i8"), ("tool_feed", "i8"), ("has_side", "i8"),
    ("m", "i8", MOST_M), ("m_count", "i8"),
])  # fmt: skip
#: what the reader remembers beside the controller; NaN for none
KLARTEXT = np.dtype([
    ("pole", "f8", 2), ("feed", "f8"), ("tool_feed", "f8"),
    # the last line or arc: its ends, the centre, the radius, the sense
    ("piece", "i8"), ("start", "f8", 2), ("end", "f8", 2), ("centre", "f8", 2),
    ("radius", "f8"), ("sense", "i8"),
])  # fmt: skip
#: kinds of the last piece
NO_PIECE, LINE, ARC, RADIUS = range(4)
_NOTHING, _L, _C, _CR, _CC = range(5)

_NEWLINE, _BLANK, _TAB, _RETURN, _SEMICOLON, _TILDE, _COMMA, _POINT, _PLUS, _MINUS = (
    ord(c) for c in "\n \t\r;~,.+-"
)
_A, _LETTER_C, _D, _F, _H, _I, _LETTER_L, _M, _N, _O, _R, _T, _U, _X, _Z = (
    ord(c) for c in "acdfhilmnortuxz"
)
_PLACE = ord("x") - _A, ord("i") - _A
_RADIUS_WORD, _OF_RADIUS = ord("r") - _A, bit("r")
_OF_I, _OF_J = bit("i"), bit("j")
#: numbers below are written with 20 decimals for the interpreter, which may round them
_LEAST = 1e-4


@njit_part
def _is_digit(c):  # pragma: no cover - compiled
    return 48 <= c <= 57


@njit_part
def _is_gap(c):  # pragma: no cover - compiled
    return c in (_BLANK, _TAB, _RETURN)


@njit_part
def _past_gap(data, at):  # pragma: no cover - compiled
    while _is_gap(data[at]):
        at += 1
    return at


@njit_part
def _is_word(data, at, second, third):  # pragma: no cover - compiled
    """Whether two letters, in lower case, follow the one that stands there."""
    return data[at + 1] | 32 == second and data[at + 2] | 32 == third


@njit_part
def _read_head(data, at, b):  # pragma: no cover - compiled
    """Block number and first word; returns where the words begin, -1 where not understood."""
    at = _past_gap(data, at)
    if _is_digit(data[at]):
        while _is_digit(data[at]):
            at += 1
        if not (_is_gap(data[at]) or data[at] == _NEWLINE):
            return -1
        at = _past_gap(data, at)
    letter, b.head = data[at] | 32, _NOTHING
    if letter == _LETTER_L:
        b.head = _L
    elif letter == _LETTER_C:
        b.head = _C
        following = data[at + 1] | 32
        if following in (_LETTER_C, _R):
            b.head = _CC if following == _LETTER_C else _CR
            at += 1
    else:
        return at
    at += 1
    c = data[at]
    return at if _is_gap(c) or c in (_NEWLINE, _SEMICOLON) else -1


@njit_part
def _read(data, at, b):  # pragma: no cover - compiled
    """Read one line into BLOCK; returns where the next begins, -1 where it is not understood."""
    b.said = b.incremental = b.sense = b.rapid = b.tool_feed = b.has_side = b.m_count = 0
    b.radius = b.feed = np.nan
    at = _read_head(data, at, b)
    while at >= 0:
        c = data[at]
        if c == _NEWLINE:
            return at + 1
        if _is_gap(c):
            at += 1
        elif c == _SEMICOLON:
            while data[at] != _NEWLINE:
                if data[at] == _TILDE:  # the block goes on in the next line
                    return -1
                at += 1
        elif b.head == _NOTHING:
            return -1
        else:
            at = _read_word(data, at, b)
    return -1


@njit_part
def _read_word(data, at, b):  # pragma: no cover - compiled
    """Read one word; returns where it ends, -1 where it is not understood."""
    letter = data[at] | 32
    if data[at] < 65:
        return -1
    if letter == _I or _X <= letter <= _Z:
        return _read_place(data, at, b)
    if letter == _F:
        return _read_feed(data, at, b)
    if letter == _D:
        sign = data[at + 2] if data[at + 1] | 32 == _R else _NEWLINE
        if sign not in (_PLUS, _MINUS):
            return -1
        b.sense = 1 if sign == _PLUS else -1
        at = _past_gap(data, at + 3)
        return -1 if _is_digit(data[at]) or data[at] == _POINT else at
    if letter == _R:
        if data[at + 1] == 48 and not (_is_digit(data[at + 2]) or data[at + 2] in (_POINT, _COMMA)):
            b.has_side = 1
            return at + 2
        if not np.isnan(b.radius):
            return -1
        b.radius, _, at = read_number(data, _past_gap(data, at + 1), True)
        return at
    if letter == _M:
        value, decimals, at = read_number(data, _past_gap(data, at + 1), True)
        if at < 0 or decimals >= 0 or value < 0.0 or b.m_count == MOST_M:
            return -1
        code = np.int64(value)
        if not (3 <= code <= 5 or 7 <= code <= 9 or 13 <= code <= 14):
            return -1
        b.m[b.m_count] = code
        b.m_count += 1
        return at
    return -1


@njit_part
def _read_place(data, at, b):  # pragma: no cover - compiled
    """X or IX."""
    is_incremental = data[at] | 32 == _I
    if is_incremental:
        at += 1
    axis = np.int64(data[at] | 32) - _X
    if not 0 <= axis <= 2 or data[at] < 65 or b.said & (1 << axis):
        return -1
    value, _, at = read_number(data, _past_gap(data, at + 1), True)
    b.value[axis] = value
    b.said |= 1 << axis
    if is_incremental:
        b.incremental |= 1 << axis
    return at


@njit_part
def _read_feed(data, at, b):  # pragma: no cover - compiled
    """F with a number, FMAX or FAUTO."""
    at = _past_gap(data, at + 1)
    letter = data[at] | 32
    if letter == _M and _is_word(data, at, _A, _X):
        b.rapid = 1
        return at + 3
    if letter == _A and _is_word(data, at, _U, _T) and data[at + 3] | 32 == _O:
        b.tool_feed = 1
        return at + 4
    if not np.isnan(b.feed):
        return -1
    b.feed, _, at = read_number(data, at, True)
    return at


@njit_part
def _may_be_corner(data, at):  # pragma: no cover - compiled
    """Whether RND or CHF may stand in the line that begins there: this one would wait for it."""
    if at >= data.shape[0]:
        return True
    at = _past_gap(data, at)
    while _is_digit(data[at]):
        at += 1
    at = _past_gap(data, at)
    c = data[at]
    letter = c | 32
    if not (_A <= letter <= _Z):
        return c not in (_NEWLINE, _SEMICOLON)
    return (letter == _R and data[at + 1] | 32 == _N) or (
        letter == _LETTER_C and data[at + 1] | 32 == _H
    )


@njit_part
def _is_rounded(value):  # pragma: no cover - compiled
    """Whether a calculated number changes where it is written."""
    return value != 0.0 and abs(value) < _LEAST


@njit_part
def _end(b, s, axis):  # pragma: no cover - compiled
    """Where a line ends."""
    flag = 1 << axis
    if b.said & flag == 0:
        return s.position[axis] + 0.0
    return s.position[axis] + b.value[axis] if b.incremental & flag else b.value[axis]


@njit_part
def _is_exact(b, axis, end):  # pragma: no cover - compiled
    """Whether the end of an axis comes from the text, or does not change where it is written."""
    flag = 1 << axis
    return b.said & ~b.incremental & flag != 0 or not _is_rounded(end)


@njit_part
def _obey(b, w, s, k, out):  # pragma: no cover - compiled
    """Obey one line; tells whether that was possible."""
    if b.head == _NOTHING:
        return True
    if b.head == _CC:
        if b.said & 4 or b.sense or b.m_count or b.rapid or b.tool_feed or b.has_side:
            return False
        if not (np.isnan(b.radius) and np.isnan(b.feed)):
            return False
        x, y = _end(b, s, 0), _end(b, s, 1)
        k.pole[0], k.pole[1] = x, y
        return True
    if not np.isnan(b.feed):
        k.feed = b.feed
    if b.tool_feed:
        k.feed = k.tool_feed
    for index in range(b.m_count):
        code = b.m[index]
        if code not in (5, 9):
            _m_code(s, out, code)
    if not (_line(b, w, s, k, out) if b.head == _L else _arc(b, w, s, k, out)):
        return False
    for index in range(b.m_count):
        code = b.m[index]
        if code in (5, 9):
            _m_code(s, out, code)
    return True


@njit_part
def _m_code(s, out, code):  # pragma: no cover - compiled
    """M3 to M5, M7 to M9; M13 and M14 switch the coolant on too."""
    after_tool_change(s)
    if code <= 5:
        spindle(s, out, code)
    elif code <= 9:
        coolant(s, out, code)
    else:
        spindle(s, out, code - 10)
        coolant(s, out, 8)


@njit_part
def _say_feed(s, k, out):  # pragma: no cover - compiled
    """F, which counts 0.1 inch/min in programs in inches; tells whether there is one."""
    feed = k.feed
    if np.isnan(feed) or feed < 0.0:
        return False
    if s.unit_mm != 1.0:
        feed /= 10.0
        if _is_rounded(feed):
            return False
    set_feed(s, out, feed)
    return True


@njit_part
def _line(b, w, s, k, out):  # pragma: no cover - compiled
    """L."""
    if b.sense or not np.isnan(b.radius):
        return False
    x, y = _end(b, s, 0), _end(b, s, 1)
    k.piece, k.sense = LINE, 0
    k.start[0], k.start[1], k.end[0], k.end[1] = s.position[0], s.position[1], x, y
    if not b.said:
        return True
    w.seen = 0
    for axis in range(3):
        if b.said & (1 << axis):
            end, letter = _end(b, s, axis), _PLACE[0] + axis
            if not _is_exact(b, axis, end):
                return False
            w.value[letter] = end
            w.seen |= 1 << letter
    after_tool_change(s)
    if b.rapid:
        return move(w, s, out, 0)
    return _say_feed(s, k, out) and move(w, s, out, 10)


@njit_part
def _arc(b, w, s, k, out):  # pragma: no cover - compiled
    """C about the pole, CR by its radius."""
    by_radius = b.head == _CR
    if b.rapid or b.sense == 0 or np.isnan(b.radius) == by_radius or s.plane != 1:
        return False
    if not by_radius and np.isnan(k.pole[0]):
        return False
    k.piece, k.sense, k.radius = RADIUS if by_radius else ARC, b.sense, b.radius
    k.centre[0], k.centre[1] = k.pole[0], k.pole[1]
    w.seen = 0
    for axis in range(3):
        end, letter = _end(b, s, axis), _PLACE[0] + axis
        if axis < 2:
            k.start[axis], k.end[axis] = s.position[axis], end
        elif end == s.position[axis]:
            break
        if not _is_exact(b, axis, end):
            return False
        w.value[letter] = end
        w.seen |= 1 << letter
    if by_radius:
        w.value[_RADIUS_WORD] = b.radius
        w.seen |= _OF_RADIUS
    else:
        for axis in range(2):
            offset = k.pole[axis] - s.position[axis]
            if _is_rounded(offset):
                return False
            w.value[_PLACE[1] + axis] = offset
        w.seen |= _OF_I | _OF_J
    after_tool_change(s)
    return _say_feed(s, k, out) and move(w, s, out, 30 if b.sense > 0 else 20)


@njit_kernel
def obey_klartext_lines(
    data, at, line, state, kept, words, block, klartext, out
):  # pragma: no cover - compiled
    """Obey lines from a byte offset on; arguments and result as those of `obey_lines`.

    Beside them ``block`` (1,) BLOCK is room, and ``klartext`` (2,) KLARTEXT changes in its first.
    """
    s, w, b, k, size = state[0], words[0], block[0], klartext[0], data.shape[0]
    s.rows = s.arcs = s.dwells = s.events = s.wide = s.notes = s.is_full = 0
    while at < size:
        end = _read(data, at, b)
        if end < 0:
            break
        if b.head in (_L, _C, _CR) and not b.rapid and _may_be_corner(data, end):
            break
        if b.head != _NOTHING:
            kept[0], klartext[1] = state[0], klartext[0]
            s.line = line + 1
            if not _obey(b, w, s, k, out) or s.is_full:
                is_full = s.is_full
                state[0], klartext[0] = kept[0], klartext[1]
                s.is_full = is_full
                break
        at, line = end, line + 1
    s.line = line
    return at, line
