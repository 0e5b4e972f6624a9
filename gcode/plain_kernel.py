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

_X, _Y, _Z, _F, _G, _N = 1, 2, 4, 8, 16, 32
_AXES = _X | _Y | _Z


@njit(cache=True)
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


@njit(cache=True)
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
        start = at
        seen = 0
        new_x = new_y = new_z = 0.0
        new_motion, new_feed = motion, feed
        understood = True
        while True:
            c = data[at]
            if c == 10:
                break
            if c == 32 or c == 13 or c == 9:
                at += 1
                continue
            if c == 40 or c == 59:
                at = _skip_comment(data, at)
                if at < 0:
                    understood = False
                    break
                continue
            letter = c | 32
            at += 1
            while data[at] == 32:
                at += 1
            negative = False
            if data[at] == 45:
                negative = True
                at += 1
            elif data[at] == 43:
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
                before = digits
                digit = data[at] - 48
                while 0 <= digit <= 9:
                    mantissa = mantissa * 10 + digit
                    digits += 1
                    at += 1
                    digit = data[at] - 48
                decimals = digits - before
                if letter == 103 or letter == 110:
                    understood = False
                    break
            if digits == 0 or digits > _DIGITS:
                understood = False
                break
            value = mantissa / _POWERS[decimals]
            if negative:
                value = -value
            if letter == 120:
                flag, new_x = _X, value
            elif letter == 121:
                flag, new_y = _Y, value
            elif letter == 122:
                flag, new_z = _Z, value
            elif letter == 102 and not negative:
                flag, new_feed = _F, value
            elif letter == 103 and not negative and mantissa <= 1:
                flag, new_motion = _G, value
            elif letter == 110 and not negative and seen == 0:
                flag = _N
            else:
                understood = False
                break
            if seen & flag:
                understood = False
                break
            seen |= flag
        moves = seen & (_AXES | _G)
        if not understood or (moves and (new_motion < 0.0 or (new_motion == 1.0 and
                                                              new_feed == 0.0))):  # fmt: skip
            at = start
            break
        at += 1
        line += 1
        motion, feed = new_motion, new_feed
        if not moves:
            continue
        if absolute:
            x = new_x if seen & _X else x
            y = new_y if seen & _Y else y
            z = new_z if seen & _Z else z
        else:
            x = x + new_x
            y = y + new_y
            z = z + new_z
        calls[row] = 1 if motion == 1.0 else 0
        lines[row] = line
        points[row, 0] = x * unit
        points[row, 1] = y * unit
        points[row, 2] = z * unit
        feeds[row] = feed * unit
        row += 1
    state[0], state[1], state[2], state[3], state[4] = x, y, z, motion, feed
    return at, line, row
