"""A table as CSV text, put together by compiled code.

The text is that of Python's ``csv`` module with ``format`` or ``repr`` of every number, to the
character. A number that decimal digits of a scaled integer cannot tell for sure (a tie of its
rounding, one that wants an exponent) is left to Python.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np
from numba import njit

__all__ = ["Cells", "fixed", "rounded", "whole", "words", "write_csv"]

#: rows put together at a time: some MB of text
_ROWS = 50_000
#: scaled numbers up to this many are told by their digits; a double is exact to 15 of them
_LARGEST = 1e15
#: relative error of a scaled number, twice the rounding of one product
_PRODUCT = 2.3e-16
#: digits of the largest int64, sign, point and comma
_WIDEST = 24
#: what divides cells and rows
_DIVIDES = re.compile('[,"\r\n]')
#: ``repr`` writes smaller numbers with an exponent
_SMALLEST_PLAIN = 1e-4


@dataclass(frozen=True)
class Cells:
    """The N cells of one column.

    Attributes
    ----------
    values : (N,) float64 or int64
        Numbers; of words the index into `names`.
    written : callable, optional
        What Python makes of one number; None for words.
    decimals : int
        Digits behind the point of a number that is written by its digits.
    is_trimmed : bool
        Zeros at the end are left out, but for the first digit behind the point.
    shown : (N,) bool, optional
        Other cells are empty.
    names : (K,) str, optional
        Words that the cells hold.
    """

    values: np.ndarray
    written: Callable[[float], str] | None
    decimals: int = 0
    is_trimmed: bool = False
    shown: np.ndarray | None = None
    names: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.values)


def fixed(values: np.ndarray, decimals: int, *, shown: np.ndarray | None = None) -> Cells:
    """Numbers, (N,), as ``f"{value:.{decimals}f}"`` writes them."""
    return Cells(np.asarray(values, np.float64), f"{{:.{decimals}f}}".format, decimals, shown=shown)


def rounded(values: np.ndarray, decimals: int) -> Cells:
    """Numbers, (N,), as ``repr`` writes them after ``numpy.round``."""
    return Cells(np.asarray(values, np.float64).round(decimals), repr, decimals, is_trimmed=True)


def whole(values: np.ndarray, *, shown: np.ndarray | None = None) -> Cells:
    """Whole numbers, (N,)."""
    return Cells(np.asarray(values, np.int64), str, shown=shown)


def words(names: Sequence[str] | np.ndarray, index: np.ndarray | None = None) -> Cells:
    """Words: `names` themselves, or for every cell the one at `index`, (N,)."""
    known = np.asarray(names, dtype=str)
    return Cells(np.arange(len(known)) if index is None else np.asarray(index), None, names=known)


def write_csv(file: BinaryIO, columns: Mapping[str, Cells]) -> None:
    """Write a heading and the rows, lines ended by a line feed.

    Parameters
    ----------
    file : binary file
        Written in UTF-8, some ten thousand rows at a time.
    columns : mapping of str to Cells
        Of equal length.
    """
    file.write((",".join(map(_quoted, columns)) + "\n").encode())
    cells = list(columns.values())
    for begin in range(0, len(cells[0]), _ROWS):
        file.write(_text([_part(c, slice(begin, begin + _ROWS)) for c in cells]))


def _part(cells: Cells, rows: slice) -> Cells:
    shown = None if cells.shown is None else cells.shown[rows]
    return Cells(cells.values[rows], cells.written, cells.decimals, cells.is_trimmed, shown,
                 cells.names)  # fmt: skip


def _quoted(word: str) -> str:
    """A word as a CSV cell: in quotes where it holds what divides cells."""
    if not _DIVIDES.search(word):
        return word
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow([word])
    return text.getvalue()[:-1]


class _Words:
    """Pieces of text, one behind the other, and where each lies."""

    def __init__(self) -> None:
        self.pieces: list[bytes] = []
        self.length = 0

    def add(self, texts: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
        """Where the texts begin, and their lengths, both (N,) int64."""
        encoded = [text.encode() for text in texts]
        size = np.fromiter(map(len, encoded), np.int64, len(encoded))
        begin = self.length + np.cumsum(size) - size
        self.pieces += encoded
        self.length += int(size.sum())
        return begin, size


def _text(columns: list[Cells]) -> memoryview:
    """The rows of a few columns as text."""
    count = len(columns[0])
    shape = (len(columns), count)
    magnitude, size = np.zeros(shape, np.int64), np.full(shape, -1, np.int64)
    is_negative = np.zeros(shape, bool)
    pool = _Words()
    for cells, number, length, negative in zip(columns, magnitude, size, is_negative, strict=True):
        if cells.names is not None:
            texts = cells.names[cells.values].tolist()
            number_of = {text: k for k, text in enumerate(dict.fromkeys(texts))}
            place = np.fromiter(map(number_of.__getitem__, texts), np.int64, count)
            begin, lengths = pool.add([_quoted(text) for text in number_of])
            number[:], length[:] = begin[place], lengths[place]
            continue
        number[:], negative[:], is_sure = _digits(cells)
        if cells.shown is not None:
            length[~cells.shown] = 0
            is_sure = is_sure | ~cells.shown
        open_ = np.flatnonzero(~is_sure)
        texts = [(cells.written or str)(value) for value in cells.values[open_].tolist()]
        number[open_], length[open_] = pool.add(texts)
    style = np.array([(c.decimals, c.is_trimmed) for c in columns], np.int64)
    text = np.empty(int(np.maximum(size, 0).sum()) + shape[0] * count * _WIDEST, np.uint8)
    letters = np.frombuffer(b"".join(pool.pieces) or b" ", np.uint8)
    used = _put_rows(text, (magnitude, size, is_negative), style, letters)
    return text[:used].data


def _digits(cells: Cells) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The digits of numbers as whole numbers, which are negative, and which of them are sure."""
    values = cells.values
    if values.dtype == np.int64:
        return np.abs(values), values < 0, np.ones(len(values), bool)
    scaled = np.abs(values) * 10.0**cells.decimals
    is_sure = scaled < _LARGEST  # not where a number is none
    scaled = np.where(is_sure, scaled, 0.0)
    if cells.is_trimmed:
        digits = np.rint(scaled).astype(np.int64)
        is_sure &= (values == 0.0) | (np.abs(values) >= _SMALLEST_PLAIN)
    else:
        digits = np.floor(scaled + 0.5).astype(np.int64)
        is_sure &= np.abs(scaled - np.floor(scaled) - 0.5) > _PRODUCT * scaled
    return digits, np.signbit(values), is_sure


@njit(cache=True, nogil=True)
def _put_rows(
    text: np.ndarray, cells: tuple[np.ndarray, ...], style: np.ndarray, letters: np.ndarray
) -> int:  # pragma: no cover - compiled
    """Write the cells of all rows; returns the length of the text.

    A cell with a size of -1 is a number told by its digits, another one a piece of `letters`.
    """
    number, size, is_negative = cells
    at = 0
    for row in range(number.shape[1]):
        for column in range(number.shape[0]):
            if column > 0:
                text[at] = 44
                at += 1
            if size[column, row] >= 0:
                begin = number[column, row]
                for k in range(size[column, row]):
                    text[at] = letters[begin + k]
                    at += 1
                continue
            if is_negative[column, row]:
                text[at] = 45
                at += 1
            at = _put_number(text, at, number[column, row], style[column])
        text[at] = 10
        at += 1
    return at


@njit(cache=True, nogil=True)
def _put_number(  # pragma: no cover - compiled
    text: np.ndarray, at: int, digits: int, style: np.ndarray
) -> int:
    """Write a whole number with a point before the last digits; returns where it ends."""
    behind = style[0]
    if style[1]:
        while behind > 1 and digits % 10 == 0:
            digits //= 10
            behind -= 1
    length, rest = 1, digits // 10
    while rest > 0:
        length += 1
        rest //= 10
    if length <= behind:
        length = behind + 1
    end = at + length + (1 if behind > 0 else 0)
    place = end
    for k in range(length):
        if k == behind and k > 0:
            place -= 1
            text[place] = 46
        place -= 1
        text[place] = 48 + digits % 10
        digits //= 10
    return end
