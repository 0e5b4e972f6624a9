"""Compiled reader for stretches of plain motion: N, G0, G1, X, Y, Z, F and comments.

It obeys line after line as long as it understands every character and stops before the first
line that it does not; the interpreter takes that one. It makes the same operations in the same
order as the interpreter, so both give the same bits: a number of up to 15 digits is an exact
integer divided by an exact power of ten, which rounds as correctly as the text's conversion.
"""

from __future__ import annotations

import numpy as np
from numba import njit

__all__ = ["plain_stretch"]

_POWERS = 10.0 ** np.arange(16)
_DIGITS = 15

_inlined = njit(inline="always", error_model="numpy")  # calls would cost a quarter of the speed

#: Where the value of a word goes; then what else a character may be.
_SLOT_G, _SLOT_F, _SLOT_N, _SPACE, _END, _COMMENT, _OTHER = 3, 4, 5, 6, 7, 8, 9
_AXES, _G, _F = 0b111, 1 << _SLOT_G, 1 << _SLOT_F
_REMARK = 1 << _SLOT_N  #: a line number or a comment: no N may follow
_SLOTS = np.full(256, _OTHER, np.uint8)
for _slot, _letter in enumerate("XYZGFN"):
    _SLOTS[ord(_letter)] = _SLOTS[ord(_letter.lower())] = _slot
_SLOTS[[32, 9, 13]] = _SPACE
_SLOTS[10] = _END
_SLOTS[[40, 59]] = _COMMENT


@njit(cache=True, error_model="numpy")
def _skip_comment(data, at):  # pragma: no cover - compiled
    """Return the index after a comment without a comma, or -1 where the interpreter must look."""
    if data[at] == 59:  # ;
        while data[at] != 10:
            at += 1
        return at
    at += 1
    while data[at] != 41:  # )
        if data[at] == 10 or data[at] == 40 or data[at] == 44:
            return -1
        at += 1
    return at + 1


@_inlined
def _read_number(data, at):  # pragma: no cover - compiled
    """Read a number; returns the index after it, its value, and its digits after the point.

    Digits after the point are -2 where this is no number that an exact division gives.
    """
    while data[at] == 32:
        at += 1
    negative = data[at] == 45
    if negative or data[at] == 43:
        at += 1
    mantissa, first = 0, at
    digit = data[at] - 48
    while 0 <= digit <= 9:
        mantissa = mantissa * 10 + digit
        at += 1
        digit = data[at] - 48
    digits, decimals = at - first, 0
    if data[at] == 46:
        at += 1
        first = at
        digit = data[at] - 48
        while 0 <= digit <= 9:
            mantissa = mantissa * 10 + digit
            at += 1
            digit = data[at] - 48
        decimals = at - first
        digits += decimals
    if digits == 0 or digits > _DIGITS:
        return at, 0.0, -2
    value = mantissa / _POWERS[decimals]
    return at, -value if negative else value, decimals


@njit(cache=True, error_model="numpy")
def _may_stand(slot, value):  # pragma: no cover - compiled
    """Tell whether G or F has a value that needs no interpreter."""
    if slot == _SLOT_G:
        return value == 0.0 or value == 1.0
    return value > 0.0 or (value == 0.0 and not np.signbit(value))


@_inlined
def _read_line(data, at):  # pragma: no cover - compiled
    """Read one line; returns where the next begins, which words stand here, and X Y Z G F.

    Which words stand here is one bit each, or -1 where the interpreter must look at the line.
    """
    seen = 0
    x = y = z = g = f = 0.0
    while True:
        slot = _SLOTS[data[at]]
        if slot <= _SLOT_F:
            at, value, decimals = _read_number(data, at + 1)
            flag = 1 << slot
            if decimals == -2 or seen & flag:
                return at, -1, x, y, z, g, f
            if slot >= _SLOT_G and not _may_stand(slot, value):
                return at, -1, x, y, z, g, f
            if slot == 0:
                x = value
            elif slot == 1:
                y = value
            elif slot == 2:
                z = value
            elif slot == _SLOT_G:
                g = value
            else:
                f = value
            seen |= flag
        elif slot == _SPACE:
            at += 1
        elif slot == _END:
            return at + 1, seen, x, y, z, g, f
        elif slot == _COMMENT:
            at = _skip_comment(data, at)
            if at < 0:
                return at, -1, x, y, z, g, f
            seen |= _REMARK
        elif slot == _SLOT_N and seen == 0 and 48 <= data[at + 1] <= 57:
            at += 1
            while 48 <= data[at] <= 57:
                at += 1
            seen = _REMARK
        else:
            return at, -1, x, y, z, g, f


@njit(cache=True, error_model="numpy")
def plain_stretch(data, at, state, rows, first_row, line):  # pragma: no cover - compiled
    """Obey plain lines from a byte offset on.

    Parameters
    ----------
    data : (bytes,) uint8
        The program, ending with a newline.
    at : int
        Offset of the first byte of a line.
    state : (7,) float64
        X, Y, Z in program units, motion (0, 1, or -1 for another), feed, unit in mm, and 1 for
        absolute distances; changed in place.
    rows : tuple of array
        call (R,) int8, line (R,) int32, point (R, 3) float64 mm, feed (R,) float64 mm/min;
        filled from `first_row` on.
    first_row : int
        Where to write.
    line : int
        0-based number of the line at `at`.

    Returns
    -------
    tuple of int
        Offset and 0-based number of the first line that was not obeyed, and the next free row.
    """
    calls, lines, points, feeds = rows
    size, capacity = data.shape[0], calls.shape[0]
    x, y, z, motion, feed, unit = state[0], state[1], state[2], state[3], state[4], state[5]
    absolute = state[6] != 0.0
    row = first_row
    while at < size and row < capacity:
        end, seen, word_x, word_y, word_z, word_g, word_f = _read_line(data, at)
        if seen < 0:
            break
        new_motion = word_g if seen & _G else motion
        new_feed = word_f if seen & _F else feed
        moves = seen & (_AXES | _G)
        if moves and (new_motion < 0.0 or (new_motion == 1.0 and new_feed == 0.0)):
            break
        at, line = end, line + 1
        motion, feed = new_motion, new_feed
        if not moves:
            continue
        if absolute:
            x = word_x if seen & 1 else x
            y = word_y if seen & 2 else y
            z = word_z if seen & 4 else z
        else:
            x = x + word_x if seen & 1 else x
            y = y + word_y if seen & 2 else y
            z = z + word_z if seen & 4 else z
        calls[row] = 1 if motion == 1.0 else 0
        lines[row] = line
        points[row, 0], points[row, 1], points[row, 2] = x * unit, y * unit, z * unit
        feeds[row] = feed * unit
        row += 1
    state[0], state[1], state[2], state[3], state[4] = x, y, z, motion, feed
    return at, line, row
