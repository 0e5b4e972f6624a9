"""Words X Y Z of the lines of moves, where they are plain numbers, found by compiled code."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

__all__ = ["AxisWords", "axis_words"]

_POWERS = 10.0 ** np.arange(16)
_DIGITS = 15  #: whole numbers of so many digits are exact, and so are these powers of ten
_POSITION = tuple(ord(letter) for letter in "IJKRP")
_X, _G, _A = ord("X"), ord("G"), ord("A")


class AxisWords(NamedTuple):
    """Words of M moves' lines.

    Attributes
    ----------
    is_plain : (M,) bool
        The line has letters with plain numbers and comments only, each axis once, and no word of
        an arc.
    start, stop : (M, 3) int64
        Span of every number in the text; -1 for an axis without a word.
    value : (M, 3) float64
    fill : (M, 3) int64
        Decimals that are written.
    is_bare, has_plus, has_minus, has_zero : (M, 3) bool
        The number begins with a point after its sign; has a sign; begins with ``0`` itself.
    motion : (M,) int64
        Which of G0 to G3 is said, -1 for none.
    """

    is_plain: np.ndarray
    start: np.ndarray
    stop: np.ndarray
    value: np.ndarray
    fill: np.ndarray
    is_bare: np.ndarray
    has_plus: np.ndarray
    has_minus: np.ndarray
    has_zero: np.ndarray
    motion: np.ndarray


def axis_words(data: bytes, line_starts: np.ndarray, line: np.ndarray) -> AxisWords:
    """Words of lines.

    Parameters
    ----------
    data : bytes
        The program.
    line_starts : (L + 1,) int64
        Offsets of its lines.
    line : (M,) int64
        1-based lines.
    """
    count = len(line)
    flags = [np.zeros((count, 3), bool) for _ in range(4)]
    found = AxisWords(np.zeros(count, bool), np.full((count, 3), -1), np.full((count, 3), -1),
                      np.zeros((count, 3)), np.zeros((count, 3), np.int64), *flags,
                      np.full(count, -1))  # fmt: skip
    text = np.frombuffer(data + b"\n", np.uint8)
    _read_lines(text, line_starts[line - 1], line_starts[line], found)
    return found


@njit(cache=True)
def _read_lines(data, first, last, found):  # pragma: no cover - compiled
    for k in range(len(first)):
        found.is_plain[k] = _read_line(data, first[k], last[k], k, found)


@njit(cache=True)
def _read_line(data, at, last, k, found):  # pragma: no cover - compiled
    """Find the words of one line; tells whether it is plain."""
    while at < last:
        c = data[at]
        if c in (32, 9, 13, 10):
            at += 1
            continue
        if c == 59:  # ;
            return True
        if c == 40:  # (
            while at < last and data[at] != 41:
                at += 1
                if data[at] == 40:
                    return False
            if at == last:
                return False
            at += 1
            continue
        letter = c & 223
        at += 1
        begin = at
        sign = data[at]
        if sign in (43, 45):
            at += 1
        body = at
        mantissa, digits, decimals = 0, 0, -1
        while True:
            digit = np.int64(data[at]) - 48
            if 0 <= digit <= 9:
                mantissa = mantissa * 10 + digit
                digits += 1
                decimals += decimals >= 0
            elif data[at] == 46 and decimals < 0:
                decimals = 0
            else:
                break
            at += 1
        if not _A <= letter <= _A + 25 or digits == 0 or digits > _DIGITS:
            return False
        for other in _POSITION:
            if letter == other:
                return False
        value = mantissa / _POWERS[max(decimals, 0)] * (-1.0 if sign == 45 else 1.0)
        is_motion = letter == _G and 0.0 <= value <= 3.0 and value == np.floor(value)
        if is_motion and found.motion[k] < 0:
            found.motion[k] = np.int64(value)
        axis = letter - _X
        if 0 <= axis <= 2:
            if found.start[k, axis] >= 0:
                return False
            found.start[k, axis] = begin
            found.stop[k, axis] = at
            found.value[k, axis] = value
            found.fill[k, axis] = max(decimals, 0)
            found.is_bare[k, axis] = data[body] == 46
            found.has_plus[k, axis] = sign == 43
            found.has_minus[k, axis] = sign == 45
            found.has_zero[k, axis] = data[begin] == 48
    return True
