"""A program's text while some of its lines are replaced by others."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from gcode import Program, Source

__all__ = ["Expanded", "LineBuilder", "number_text"]

#: decimals of lengths between two readings; the target's resolution comes last
_DECIMALS = 12
_COUNTS = "DGHLMNPST"  #: letters whose values are counts: no decimal point where they are whole
_RATES = "FS"


@dataclass(frozen=True)
class Expanded:
    """A program's text with some lines written out in plain blocks.

    Attributes
    ----------
    source : Source
        The new text, under the name of the user's file.
    origin : (L,) int64
        For every line of it the 1-based line that it comes from.
    written : frozenset of int
        Lines of the new text whose numbers are not the user's.
    reasons : dict
        Line of the old text -> why it was expanded.
    """

    source: Source
    origin: np.ndarray
    written: frozenset[int]
    reasons: dict[int, str]

    @classmethod
    def unchanged(cls, program: Program) -> Expanded:
        """The program as it is."""
        return cls(program.source, np.arange(1, len(program.source) + 1), frozenset(), {})

    def user_line(self, line: int | np.ndarray) -> np.ndarray:
        """1-based lines of the user's program for lines of the new text, (L,) or one."""
        return self.origin[np.asarray(line) - 1]

    def then(self, later: Expanded) -> Expanded:
        """Both expansions in one, lines and reasons told in the lines of the first text."""
        origin = self.origin[later.origin - 1]
        kept = {k for k, line in enumerate(later.origin.tolist(), 1) if line in self.written}
        reasons = {int(self.origin[line - 1]): why for line, why in later.reasons.items()}
        return Expanded(later.source, origin, later.written | kept, reasons | self.reasons)


@dataclass
class LineBuilder:
    """Collects the lines of the new text."""

    program: Program
    texts: list[bytes] = field(default_factory=list)
    origin: list[np.ndarray] = field(default_factory=list)
    count: int = 0
    written: set[int] = field(default_factory=set)
    reasons: dict[int, str] = field(default_factory=dict)

    def keep(self, line: int, last: int | None = None) -> None:
        """Copy a line, or all from one to the `last`, byte for byte."""
        starts, last = self.program.source.line_starts, line if last is None else last
        self._add(self.program.source.data[starts[line - 1] : starts[last]], line, last)

    def write(self, line: int, text: str, why: str, *, numbers: bool = True) -> None:
        """Add a line that takes the place of an old one, or a part of it.

        Parameters
        ----------
        line : int
            The old one.
        text : str
            Without line ending.
        why : str
            For the report.
        numbers : bool
            Whether it has numbers that are not the user's.
        """
        self._add(text.encode("latin-1") + self._line_ending(line), line, line)
        self.reasons.setdefault(line, why)
        if numbers:
            self.written.add(self.count)

    def drop(self, line: int, why: str) -> None:
        """Leave a line out."""
        self.reasons.setdefault(line, why)

    @property
    def last_origin(self) -> int:
        """The old line that the last one comes from."""
        return int(self.origin[-1][-1])

    def _add(self, data: bytes, first: int, last: int) -> None:
        if self.texts and not self.texts[-1].endswith(b"\n"):
            self.texts[-1] += self._line_ending(self.last_origin)
        self.texts.append(data)
        self.origin.append(np.arange(first, last + 1))
        self.count += last - first + 1

    def _line_ending(self, line: int) -> bytes:
        starts = self.program.source.line_starts
        is_cr_lf = self.program.source.data.endswith(b"\r\n", 0, int(starts[line]))
        return b"\r\n" if is_cr_lf else b"\n"

    def result(self) -> Expanded:
        """The new text."""
        source = Source(b"".join(self.texts), self.program.path)
        origin = np.concatenate([np.zeros(0, np.int64), *self.origin])
        return Expanded(source, origin, frozenset(self.written), self.reasons)


def number_text(letter: str, value: float) -> str:
    """A number as a word has it: counts without, everything else with a decimal point."""
    if letter in _COUNTS and value == round(value):
        return f"{value:.0f}"
    text = f"{value:.{6 if letter in _RATES else _DECIMALS}f}".rstrip("0")
    return text.removeprefix("-") if float(text) == 0.0 else text
