"""Token store: the exact bytes of a program and the words found in them."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from gcode.errors import ProgramError
from gcode.text.regular_file import read_regular_file

__all__ = ["Source", "Word", "readable", "readable_quotes"]

_BYTE_ORDER_MARK = b"\xef\xbb\xbf"

_NUMBER = r"[+-]?[ \t]*(?:\d[\d \t]*\.?[\d \t]*|\.[ \t]*\d[\d \t]*)"
_TOKEN = re.compile(
    r"(?P<comment>\([^)\n]*\)?|;[^\n]*)"
    r"|(?P<string>\"[^\"\n]*\"?)"
    r"|(?P<setting>\#[^=\n(;]*=)"
    r"|(?P<bracket>\[|\])"
    rf"|(?P<word>[A-Za-z@^$][ \t]*{_NUMBER})"
    r"|(?P<name><[^>\n]*>?)"
    r"|(?P<letter>[A-Za-z])"
    r"|(?P<other>.)",
    re.DOTALL,
)


#: no length has so many digits; from 309 on a number is infinite, from 4,301 on Python refuses it
_LONG_DIGITS = 100
_LONG_NUMBER = re.compile(rb"\d{%d,}" % _LONG_DIGITS)
#: of characters beyond ASCII
_BYTES = re.compile("[\x80-\xff]+")


@dataclass(frozen=True)
class Word:
    """A letter and its value as they stand in the text.

    Attributes
    ----------
    letter : str
        Upper case.
    value : float or None
        The number; None where an expression or a parameter gives the value.
    text : str
        Exact text of letter and number, or of letter and expression.
    span : tuple of int
        Byte offsets (start, stop) in the whole file.
    """

    letter: str
    value: float | None
    text: str
    span: tuple[int, int]


def readable(line: str) -> str:
    """Text of a line of a `Source` as people wrote it, for showing it.

    Its bytes are UTF-8 where they can be, else code page 1252, else they stay what they are.
    """
    if line.isascii():
        return line
    for encoding in ("utf-8", "cp1252"):
        try:
            return line.encode("latin-1").decode(encoding)
        except UnicodeError:
            continue
    return line


def readable_quotes(message: str, line: str) -> str:
    """A message about a line of a `Source`, with what it quotes as people wrote it.

    A byte of a character, also in lower case, becomes the whole character.
    """

    def whole(found: re.Match[str]) -> str:
        place = re.search(re.escape(found[0]) + "[\x80-\xbf]*", line, re.IGNORECASE)
        return readable(place[0] if place else found[0])

    return _BYTES.sub(whole, message)


class Source:
    """Exact text of one program.

    One byte is one character (latin-1), so every byte can be written back and character
    offsets are byte offsets.

    Parameters
    ----------
    data : bytes
        The whole file.
    path : path
        Name for messages.
    """

    def __init__(self, data: bytes, path: str | Path = "<program>") -> None:
        self.data = bytes(data)
        self.path = Path(path)
        #: bytes before the first line: a byte order mark that an editor left
        self.mark = len(_BYTE_ORDER_MARK) if self.data.startswith(_BYTE_ORDER_MARK) else 0

    @classmethod
    def read(cls, path: str | Path) -> Source:
        """Read a file from disk; raises ProgramError if it is no text or absurd."""
        data = read_regular_file(path)
        if b"\0" in data:
            line = data[: data.index(b"\0")].count(b"\n") + 1
            raise ProgramError(
                "the program is no text: it holds zero bytes",
                file=path,
                line=line,
                accepted="a text in ASCII, Latin-1 or UTF-8",
            )
        if b"\n" not in data and b"\r" in data.rstrip():
            raise ProgramError(
                "its lines end with carriage returns alone",
                file=path,
                line=1,
                accepted="lines that end with LF or CR LF",
                hint="write the file again with an editor that has this choice",
            )
        source = cls(data, path)
        # most programs have no line that is long enough
        longest = np.diff(source.line_starts).max(initial=0)
        long = longest >= _LONG_DIGITS and _LONG_NUMBER.search(data)
        if long:
            raise ProgramError(
                f"a number of {len(long[0])} digits",
                file=path,
                line=data[: long.start()].count(b"\n") + 1,
                accepted=f"fewer than {_LONG_DIGITS} digits",
            )
        return source

    @cached_property
    def line_starts(self) -> np.ndarray:
        """Byte offset of every line's first byte, then the file's length; (L,) int64, lines + 1."""
        ends = np.flatnonzero(np.frombuffer(self.data, np.uint8) == 10) + 1
        starts = np.concatenate(([self.mark], ends))
        last = [] if len(self.data) == starts[-1] else [len(self.data)]
        return np.concatenate((starts, last)).astype(np.int64)

    def __len__(self) -> int:
        """Return the number of lines."""
        return len(self.line_starts) - 1

    @cached_property
    def lines(self) -> list[str]:
        """Text of every line without its line ending."""
        lines = self.data[self.mark :].decode("latin-1").split("\n")
        if lines and lines[-1] == "":
            lines.pop()
        return [line[:-1] if line.endswith("\r") else line for line in lines]

    def line(self, line: int) -> str:
        """Text of one line, 1-based; a long program's `lines` take four times its size."""
        if "lines" in vars(self):
            return self.lines[line - 1]
        text = self.data[self.line_starts[line - 1] : self.line_starts[line]]
        return text.decode("latin-1").removesuffix("\n").removesuffix("\r")

    @cached_property
    def _first_cr_lf(self) -> int:
        return self.data.find(b"\r\n")

    def has_cr_lf(self, before: int) -> bool:
        """Whether a line ends with CR LF before this byte."""
        return 0 <= self._first_cr_lf <= before - 2

    def words(self, line: int) -> tuple[Word, ...]:
        """Words of a line in the order in which they stand, comments left out.

        Parameters
        ----------
        line : int
            1-based.
        """
        text, offset = self.line(line), int(self.line_starts[line - 1])
        found: list[Word] = []
        depth, expression = 0, None  # start of a word whose value is an expression
        for token in _TOKEN.finditer(text):
            kind = token.lastgroup
            if depth == 0 and expression is not None and kind in ("word", "letter", "comment"):
                found.append(_expression_word(text, expression, token.start(), offset))
                expression = None
            if kind == "bracket":
                depth += 1 if token.group() == "[" else -1
            elif depth == 0 and kind == "word":
                found.append(_number_word(token, offset))
            elif depth == 0 and kind == "letter":
                expression = token.start()
        if expression is not None:
            found.append(_expression_word(text, expression, len(text), offset))
        return tuple(found)

    def rewritten(self, replacements: Mapping[tuple[int, int], str]) -> bytes:
        """Write the program back with some spans replaced, everything else byte for byte.

        Parameters
        ----------
        replacements : mapping
            From a span (start, stop) in bytes to the text that takes its place; spans must
            not overlap.
        """
        pieces, position = [], 0
        for (start, stop), text in sorted(replacements.items()):
            if start < position:
                raise ValueError(f"replacements overlap at byte {start}")
            pieces += [self.data[position:start], text.encode("latin-1")]
            position = stop
        return b"".join([*pieces, self.data[position:]])


def _number_word(token: re.Match[str], offset: int) -> Word:
    text = token.group().rstrip()
    value = float(re.sub(r"\s", "", text[1:]))
    span = (offset + token.start(), offset + token.start() + len(text))
    return Word(text[0].upper(), value, text, span)


def _expression_word(text: str, start: int, stop: int, offset: int) -> Word:
    exact = text[start:stop].rstrip()
    return Word(exact[0].upper(), None, exact, (offset + start, offset + start + len(exact)))
