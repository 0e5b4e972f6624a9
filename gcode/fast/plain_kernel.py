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
_DIGITS = 15  #: whole numbers of so many digits are exact, and so are these powers of ten

#: Which words stand in a line, one bit each; X, Y, Z are 1, 2, 4.
_AXES, _G, _F = 7, 8, 16
_REMARK = 32  #: a line number or a comment: no N may follow


#: called by kernels only: no way in from Python has to be compiled
_part = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)


@_part
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


@_part
def _read_line(data, at):  # pragma: no cover - compiled
    """Read one line; returns where the next begins, which words stand here, and X Y Z G F.

    Which words stand here is one bit each, or -1 where the interpreter must look at the line.
    """
    seen = 0
    x = y = z = g = f = 0.0
    while True:
        c = data[at]
        if c == 10:
            return at + 1, seen, x, y, z, g, f
        if c == 32 or c == 13 or c == 9:
            at += 1
            continue
        if c == 40 or c == 59:
            at = _skip_comment(data, at)
            if at < 0:
                break
            seen |= _REMARK
            continue
        letter = c | 32
        at += 1
        if letter == 110 and seen == 0 and 48 <= data[at] <= 57:
            while 48 <= data[at] <= 57:
                at += 1
            seen = _REMARK
            continue
        while data[at] == 32:
            at += 1
        negative = data[at] == 45
        if negative or data[at] == 43:
            at += 1
        mantissa, digits, decimals = 0, 0, 0
        digit = data[at] - 48
        while 0 <= digit <= 9:
            mantissa = mantissa * 10 + digit
            digits += 1
            at += 1
            digit = data[at] - 48
        if data[at] == 46:
            at += 1
            decimals = digits
            digit = data[at] - 48
            while 0 <= digit <= 9:
                mantissa = mantissa * 10 + digit
                digits += 1
                at += 1
                digit = data[at] - 48
            decimals = digits - decimals
        if digits == 0 or digits > _DIGITS:
            break
        value = mantissa / _POWERS[decimals] * (-1.0 if negative else 1.0)
        if letter == 120:
            flag, x = 1, value
        elif letter == 121:
            flag, y = 2, value
        elif letter == 122:
            flag, z = 4, value
        elif letter == 103 and (value == 0.0 or value == 1.0):
            flag, g = _G, value
        elif letter == 102 and not negative:
            flag, f = _F, value
        else:
            break
        if seen & flag:
            break
        seen |= flag
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
