"""Where the programs and block numbers of a Fanuc text stand, looked for once."""

from __future__ import annotations

from bisect import bisect_left
from typing import TYPE_CHECKING

import numpy as np

from gcode.dialects.fanuc.macro.line_text import BLANKS, HEAD, PROGRAM, content_of

if TYPE_CHECKING:
    from gcode.dialects.fanuc.reader import FanucReader

__all__ = ["LinePlaces"]

_NO_NUMBER = -1  #: of a block without N
_TOO_LARGE = 10**18  #: for the number of a block


class LinePlaces:
    """Places that calls and jumps ask for, however often.

    Lines of files beside the program are put behind its own while it runs: what was looked for
    before is looked for in them alone.

    Parameters
    ----------
    reader : FanucReader
    """

    def __init__(self, reader: FanucReader) -> None:
        self._reader = reader
        self._read = 0  #: lines that were searched for the heads of programs
        self._heads: list[int] = []
        self._programs: dict[int | str, int] = {}
        self._numbers = np.empty(0, dtype=np.int64)
        self._order = np.empty(0, dtype=np.intp)

    def program(self, wanted: int | str) -> int | None:
        """First line of a program, by its number or by the name between ``<`` and ``>``."""
        self._read_heads()
        return self._programs.get(wanted)

    def around(self, line: int) -> tuple[int, int]:
        """First line of the program that a line belongs to, and the line where the next begins."""
        self._read_heads()
        place = bisect_left(self._heads, line + 1)  # heads up to the line itself
        start = self._heads[place - 1] if place else 0
        following = place if place else 1  # what stands before the first head belongs to it
        there = following < len(self._heads)
        return start, self._heads[following] if there else len(self._reader.lines)

    def block(self, wanted: int, here: int, start: int, stop: int) -> int | None:
        """Line of a block number: from `here` to `stop`, then from `start`; None without it."""
        lines = self._numbered(wanted)
        ahead = int(np.searchsorted(lines, here))
        if ahead < len(lines) and lines[ahead] < stop:
            return int(lines[ahead])
        behind = int(np.searchsorted(lines, start))
        return int(lines[behind]) if behind < ahead else None

    def _read_heads(self) -> None:
        lines = self._reader.lines
        for index in range(self._read, len(lines)):
            line = lines[index]
            if "O" not in line and "o" not in line and ":" not in line:
                continue
            found = PROGRAM.match(content_of(line))
            if found is not None:
                self._heads.append(index)
                name = found[2] if found[1] is None else int(found[1])
                self._programs.setdefault(name, index)
        self._read = len(lines)

    def _numbered(self, wanted: int) -> np.ndarray:
        """Lines with a block number, in their order."""
        known, lines = len(self._numbers), self._reader.lines
        if known < len(lines):
            more = (_number(lines[k]) for k in range(known, len(lines)))
            found = np.fromiter(more, dtype=np.int64, count=len(lines) - known)
            self._numbers = np.concatenate([self._numbers, found])
            self._order = np.argsort(self._numbers, kind="stable")
        if not 0 <= wanted < _TOO_LARGE:
            return self._order[:0]
        first, last = (
            np.searchsorted(self._numbers, wanted, side=side, sorter=self._order)
            for side in ("left", "right")
        )
        return self._order[first:last]


def _number(line: str) -> int:
    digits = HEAD.match(line.translate(BLANKS).lower())[1]
    number = _NO_NUMBER if digits is None else int(digits)
    return number if number < _TOO_LARGE else _NO_NUMBER
