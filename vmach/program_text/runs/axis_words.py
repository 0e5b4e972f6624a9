"""Words of the lines of moves, where they are plain numbers, found by compiled code."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

__all__ = ["LETTERS", "RADIUS", "AxisWords", "axis_words"]

#: letters by their columns: ends, centre and radius
LETTERS = "XYZIJKR"
RADIUS = LETTERS.index("R")

_POWERS = 10.0 ** np.arange(16)
_DIGITS = 15  #: whole numbers of so many digits are exact, and so are these powers of ten
_COLUMN = np.full(26, -1)
_COLUMN[[ord(letter) - ord("A") for letter in LETTERS]] = np.arange(len(LETTERS))
_A, _C, _F, _G, _L, _M, _P, _R, _X = (ord(letter) for letter in "ACFGLMPRX")
_BLANK, _TAB, _RETURN, _NEWLINE = (ord(character) for character in " \t\r\n")
_SEMICOLON, _OPENING, _CLOSING, _EQUAL = (ord(character) for character in ";()=")
_PLUS, _MINUS, _POINT, _ZERO, _NINE = (ord(character) for character in "+-.09")
_CAPITAL = 223  #: mask that makes a letter a capital one
_MAX, _AUTO = (np.frombuffer(word, np.uint8) for word in (b"MAX", b"AUTO"))
_FORMS = ("letters", "equal signs", "klartext")


class AxisWords(NamedTuple):
    """Words of M moves' lines.

    Attributes
    ----------
    is_plain : (M,) bool
        The line has letters with plain numbers and comments only, each of `LETTERS` once at
        most, and no P.
    start, stop : (M, 7) int32, or int64 of texts beyond 2 GB
        Span of every number in the text by its letter; -1 where there is no word.
    value : (M, 3) float64
        Of X Y Z.
    fill : (M, 7) int8
        Decimals that are written.
    is_bare, has_plus, has_minus, has_zero : (M, 7) bool
        The number begins with a point after its sign; has a sign; begins with ``0`` itself.
    motion : (M,) int64
        Which of G0 to G3 is said, -1 for none.
    behind : (M,) int64
        Where a further word goes: behind the last of `LETTERS` and of G, or else of all words.
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
    behind: np.ndarray


def axis_words(
    data: bytes, line_starts: np.ndarray, line: np.ndarray, form: str = "letters"
) -> AxisWords:
    """Words of lines.

    Parameters
    ----------
    data : bytes
        The program.
    line_starts : (L + 1,) int64
        Offsets of its lines.
    line : (M,) int64
        1-based lines.
    form : str
        As `gcode.BlockText.word_form`; no line is plain in a form that is not known.
    """
    count, shape = len(line), (len(line), len(LETTERS))
    flags = [np.zeros(shape, bool) for _ in range(4)]
    place = np.int32 if len(data) < 2**31 else np.int64
    found = AxisWords(np.zeros(count, bool), np.full(shape, -1, place), np.full(shape, -1, place),
                      np.zeros((count, 3)), np.zeros(shape, np.int8), *flags,
                      np.full(count, -1), np.zeros(count, np.int64))  # fmt: skip
    text = np.frombuffer(data + b"\n", np.uint8)
    if form in _FORMS:
        _read_lines(text, line_starts[line - 1], line_starts[line], _FORMS.index(form), found)
    return found


@njit(cache=True)
def _read_lines(data, first, last, form, found):  # pragma: no cover - compiled
    for k in range(len(first)):
        if form == 2:
            found.is_plain[k] = _read_klartext(data, first[k], last[k], k, found)
        else:
            found.is_plain[k] = _read_line(data, first[k], last[k], k, found, form == 1)


@njit(cache=True)
def _number(data, at):  # pragma: no cover - compiled
    """A number that begins there: value, decimals, where it ends; -1 where there is none."""
    sign = data[at]
    if sign in (_PLUS, _MINUS):
        at += 1
    mantissa, digits, decimals = 0, 0, -1
    while True:
        digit = np.int64(data[at]) - _ZERO
        if 0 <= digit <= 9:
            mantissa = mantissa * 10 + digit
            digits += 1
            decimals += decimals >= 0
        elif data[at] == _POINT and decimals < 0:
            decimals = 0
        else:
            break
        at += 1
    if digits == 0 or digits > _DIGITS:
        return 0.0, 0, -1
    return mantissa / _POWERS[max(decimals, 0)] * (-1.0 if sign == _MINUS else 1.0), decimals, at


@njit(cache=True)
def _put(data, begin, number, place, found):  # pragma: no cover - compiled
    """Note the number of a word of `LETTERS` that begins there; False for a second one."""
    (value, decimals, at), (k, axis) = number, place
    if found.start[k, axis] >= 0:
        return False
    sign = data[begin]
    found.start[k, axis] = begin
    found.stop[k, axis] = at
    if axis < 3:
        found.value[k, axis] = value
    found.fill[k, axis] = max(decimals, 0)
    found.is_bare[k, axis] = data[begin + (sign in (_PLUS, _MINUS))] == _POINT
    found.has_plus[k, axis] = sign == _PLUS
    found.has_minus[k, axis] = sign == _MINUS
    found.has_zero[k, axis] = data[begin] == _ZERO
    return True


@njit(cache=True)
def _is_gap(c):  # pragma: no cover - compiled
    return c in (_BLANK, _TAB, _RETURN, _NEWLINE)


@njit(cache=True)
def _is_digit(c):  # pragma: no cover - compiled
    return _ZERO <= c <= _NINE


@njit(cache=True)
def _behind_gaps(data, at, last):  # pragma: no cover - compiled
    while at < last and _is_gap(data[at]):
        at += 1
    return at


@njit(cache=True)
def _behind_block_number(data, at, last):  # pragma: no cover - compiled
    """Where the word of a Klartext line begins; -1 where its number runs on into a word."""
    at = _behind_gaps(data, at, last)
    if not _is_digit(data[at]):
        return at
    while _is_digit(data[at]):
        at += 1
    return _behind_gaps(data, at, last) if _is_gap(data[at]) else -1


@njit(cache=True)
def _behind_comment(data, at, last):  # pragma: no cover - compiled
    """Where a comment in parentheses ends; -1 where another opens in it, or it does not end."""
    while at < last and data[at] != _CLOSING:
        at += 1
        if data[at] == _OPENING:
            return -1
    return -1 if at == last else at + 1


@njit(cache=True)
def _read_klartext(data, at, last, k, found):  # pragma: no cover - compiled
    """Find the words of a line L with X Y Z, F, FMAX, FAUTO, R0 and M; tells whether it is one."""
    at = _behind_block_number(data, at, last)
    if at < 0 or at >= last or data[at] & _CAPITAL != _L or not _is_gap(data[at + 1]):
        return False
    at += 1
    found.behind[k] = at
    while at < last:
        c = data[at]
        if _is_gap(c):
            at += 1
            continue
        if c == _SEMICOLON:
            return True
        letter = c & _CAPITAL
        begin = at + 1
        if letter == _F:
            at = _feed_end(data, begin)
        elif letter == _R:
            at = begin + 1 if data[begin] == _ZERO and _is_gap(data[begin + 1]) else -1
        elif letter == _M:
            value, decimals, at = _number(data, begin)
            at = at if decimals < 0 and 0.0 <= value < 100.0 else -1
        else:
            value, decimals, at = _number(data, begin)
            axis = np.int64(letter) - _X
            if at < 0 or not 0 <= axis <= 2:
                return False
            if not _put(data, begin, (value, decimals, at), (k, axis), found):
                return False
            found.behind[k] = at
        if at < 0 or not (_is_gap(data[at]) or data[at] == _SEMICOLON):
            return False
    return True


@njit(cache=True)
def _feed_end(data, at):  # pragma: no cover - compiled
    """Where F with a number, MAX or AUTO ends, -1 where it is none of them."""
    while data[at] == _BLANK:
        at += 1
    size = 3 if data[at] & _CAPITAL == _M else 4
    word = _MAX if size == 3 else _AUTO
    for offset in range(size):
        if data[at + offset] & _CAPITAL != word[offset]:
            return _number(data, at)[2]
    return at + size


@njit(cache=True)
def _read_line(data, at, last, k, found, has_equals):  # pragma: no cover - compiled
    """Find the words of one line; tells whether it is plain."""
    has_place = False
    while at < last:
        c = data[at]
        if _is_gap(c):
            at += 1
            continue
        if c == _SEMICOLON:
            return True
        if c == _OPENING:
            at = _behind_comment(data, at, last)
            if at < 0:
                return False
            continue
        letter = c & _CAPITAL
        at += 1
        is_radius = has_equals and letter == _C and data[at] & _CAPITAL == _R
        if is_radius:
            letter = _R
            at += 1
        is_equal = has_equals and data[at] == _EQUAL
        if is_equal:
            at += 1
        if has_equals and letter in (_R, _G) and is_equal != is_radius:
            return False
        begin = at
        value, decimals, at = _number(data, at)
        if not _A <= letter <= _A + 25 or at < 0 or letter == _P:
            return False
        is_motion = letter == _G and 0.0 <= value <= 3.0 and value == np.floor(value)
        if is_motion and found.motion[k] < 0:
            found.motion[k] = np.int64(value)
        axis = _COLUMN[letter - _A]
        if axis >= 0 or letter == _G or not has_place:
            found.behind[k] = at
            has_place |= axis >= 0 or letter == _G
        if axis >= 0 and not _put(data, begin, (value, decimals, at), (k, axis), found):
            return False
    return True
