"""One line of text to a flat record of its words, in compiled code.

A line is understood completely or not at all.
"""

from __future__ import annotations

import numpy as np

from gcode.fast.code_table import GROUPS
from gcode.fast.compiled import njit_part
from gcode.fast.number_word import read_number

__all__ = ["MOST_M", "WORDS", "add_code", "bit", "clear_words", "read_line"]

#: M codes of one block, at most
MOST_M = 4

#: Words of one line.
WORDS = np.dtype([
    ("value", "f8", 26),  # by letter
    ("group", "i8", len(GROUPS)),  # tenths of the G or M code of every modal group, -1 for none
    ("m", "i8", MOST_M),  # M codes in the order of the text
    ("m_count", "i8"), ("g_count", "i8"),
    ("seen", "i8"),  # a bit for each letter but G, M, N
    ("pointless", "i8"),  # the same for numbers without a decimal point
    ("letters", "i8"),  # letters that the codes take
    ("comment", "i8"),  # first byte of the last comment's text, -1 for none
    ("content", "i8"),  # 0 for a blank line
])  # fmt: skip

_NEWLINE, _BLANK, _TAB, _RETURN = 10, 32, 9, 13
_OPEN, _CLOSE, _SEMICOLON, _COMMA, _MINUS = 40, 41, 59, 44, 45
_A, _G, _M, _N = 97, 103, 109, 110
#: letters that stand in words: all but E, G, M, N, O, U, V, W
_WORD_LETTERS = sum(1 << (ord(c) - _A) for c in "abcdfhijklpqrstxyz")


def bit(letters: str) -> int:
    """Bits of some letters in `seen`."""
    return sum(1 << (ord(letter) - _A) for letter in letters)


@njit_part
def _skip_comment(data, at, with_commas):  # pragma: no cover - compiled
    """Return the index of a comment's closing parenthesis, or -1 where the interpreter must look.

    A comma may mean that the comment is a message.
    """
    at += 1
    while data[at] != _CLOSE:
        c = data[at]
        if c in (_NEWLINE, _OPEN) or (c == _COMMA and not with_commas):
            return -1
        at += 1
    return at


@njit_part
def clear_words(words):  # pragma: no cover - compiled
    """Begin a line."""
    words.seen = words.pointless = words.letters = words.content = 0
    words.g_count = words.m_count = 0
    words.comment = -1
    for group in range(len(GROUPS)):
        words.group[group] = -1


@njit_part
def add_code(words, codes, kind, value):  # pragma: no cover - compiled
    """Put a G (0) or M (1) code into its group; tells whether it is one that is obeyed here."""
    tenths = np.int64(np.floor(10.0 * value + 0.001))
    if tenths < 0 or tenths >= codes.group.shape[1] or abs(10.0 * value - tenths) > 1e-9:
        return False
    group = codes.group[kind, tenths]
    if group < 0:
        return False
    if kind == 1:
        if words.m_count == MOST_M:
            return False
        words.m[words.m_count] = tenths // 10
        words.m_count += 1
        if codes.is_sequential:
            words.letters |= codes.letters[kind, tenths]
            return True
    if words.group[group] >= 0:
        return False
    words.group[group] = tenths
    words.g_count += 1 - kind
    words.letters |= codes.letters[kind, tenths]
    return True


@njit_part
def read_line(data, at, words, codes):  # pragma: no cover - compiled
    """Read one line into `words`; returns where the next begins, -1 where it is not understood."""
    clear_words(words)
    while True:
        c = data[at]
        if c == _NEWLINE:
            return at + 1
        if c in (_BLANK, _RETURN, _TAB):
            at += 1
            continue
        if c == _OPEN:
            words.content = 1
            words.comment = at + 1
            at = _skip_comment(data, at, codes.is_sequential) + 1
            if at == 0:
                return -1
            continue
        if c == _SEMICOLON:
            words.content = 1
            while data[at] != _NEWLINE:
                at += 1
            continue
        letter = c | 32
        at += 1
        if letter == _N and words.content == 0 and 48 <= data[at] <= 57:
            while 48 <= data[at] <= 57:
                at += 1
            words.content = 1
            continue
        words.content = 1
        while data[at] == _BLANK:
            at += 1
        negative = data[at] == _MINUS
        value, decimals, at = read_number(data, at, False)
        if at < 0:
            return -1
        if letter in (_G, _M):
            if negative or not add_code(words, codes, 1 if letter == _M else 0, value):
                return -1
            continue
        flag = 1 << (letter - _A) if _A <= letter <= 122 else 0
        if flag & _WORD_LETTERS == 0 or words.seen & flag:
            return -1
        words.seen |= flag
        words.value[letter - _A] = value
        if decimals < 0:
            words.pointless |= flag
