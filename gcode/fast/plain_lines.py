"""Lines of plain motion, told by their text: G0 to G3, places, centres, F, S, N and comments."""

from __future__ import annotations

import numpy as np

from gcode.fast.compiled import njit_kernel, njit_part

__all__ = ["NO_MOTION", "OTHER", "motion_of_lines"]

#: what a line says: another thing than plain motion, no motion; else the number of its G code
OTHER, NO_MOTION = -2, -1
_TAKEN = np.zeros(256, np.bool_)
_TAKEN[[ord(letter) for letter in "XYZIJKRFSNxyzijkrfsn"]] = True
_G, _LOWER, _NEW_LINE = ord("G"), ord("a") - ord("A"), ord("\n")
_ZERO, _NINE, _POINT = ord("0"), ord("9"), ord(".")


@njit_kernel
def motion_of_lines(data, starts, said):  # pragma: no cover - compiled
    """Find what lines say.

    Parameters
    ----------
    data : (bytes,) uint8
        The program.
    starts : (L + 1,) int64
        Offsets of its lines.
    said : (L,) int8
        Receives `OTHER`, `NO_MOTION` or 0 to 3.
    """
    for line in range(said.shape[0]):
        said[line] = _motion(data, starts[line], starts[line + 1])


@njit_part
def _motion(data, at, end):  # pragma: no cover - compiled
    said = NO_MOTION
    while at < end:
        c = data[at]
        at += 1
        if c == 32 or c == 9 or c == 13 or c == _NEW_LINE:
            continue
        if c == 40 or c == 59:  # ( and ;
            at = _comment_end(data, at, end, c == 40)
            if at < 0:
                return OTHER
            continue
        is_g = c == _G or c == _G + _LOWER
        if not is_g and not _TAKEN[c]:
            return OTHER
        begin = at
        while at < end and (_ZERO <= data[at] <= _NINE or data[at] in (_POINT, 43, 45)):
            at += 1
        if at == begin:
            return OTHER
        if is_g:
            while begin < at - 1 and data[begin] == _ZERO:
                begin += 1
            code = np.int64(data[begin]) - _ZERO
            if said != NO_MOTION or at - begin != 1 or not 0 <= code <= 3:
                return OTHER
            said = code
    return said


@njit_part
def _comment_end(data, at, end, has_bracket):  # pragma: no cover - compiled
    """Where a comment ends; -1 where it may show a parameter or does not end on its line."""
    while at < end:
        c = data[at]
        at += 1
        if c == 35 or c == 40:  # a parameter, a bracket in brackets
            return -1
        if has_bracket and c == 41:
            return at
    return -1 if has_bracket else end
