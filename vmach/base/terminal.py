"""What is printed: names and texts of files never steer the user's terminal.

A file name or a cell may hold control characters: they could clear the screen, hide an error or
write text that looks like the program's. They are printed as ``\\x1b``.
"""

from __future__ import annotations

import io
import re
import sys
from typing import TYPE_CHECKING, TextIO, cast

if TYPE_CHECKING:
    from rich.console import Console

__all__ = ["console", "is_terminal", "printable", "protect_terminal"]

#: controls but tabulator and line end, marks of direction, halves of characters
_UNSAFE = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]"
)


def printable(text: str) -> str:
    """The text with every character that a terminal would obey written as its escape."""
    return _UNSAFE.sub(_escaped, text)


def _escaped(found: re.Match[str]) -> str:
    code = ord(found[0])
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"


class _PrintableStream(io.TextIOWrapper):
    """A stream of text that writes only what `printable` leaves."""

    def write(self, text: str) -> int:
        return super().write(printable(text))

    def write_controls(self, text: str) -> int:
        return super().write(text)


class _Controlling(io.TextIOBase):
    """The same stream for the program's own colours and bars."""

    def __init__(self, stream: _PrintableStream) -> None:
        self._stream = stream

    @property
    def encoding(self) -> str:  # type: ignore[override]
        return self._stream.encoding

    def write(self, text: str) -> int:
        return self._stream.write_controls(text)

    def flush(self) -> None:
        self._stream.flush()

    def isatty(self) -> bool:
        return self._stream.isatty()

    def fileno(self) -> int:
        return self._stream.fileno()


def protect_terminal() -> None:
    """From now on nothing that is printed steers the terminal but what `console` writes."""
    sys.stdout = _protected(sys.stdout)
    sys.stderr = _protected(sys.stderr)


def _protected(stream: TextIO) -> TextIO:
    if type(stream) is not io.TextIOWrapper:  # closed, or a test's
        return stream
    settings = stream.line_buffering, stream.write_through
    encoding, errors = stream.encoding, "replace"  # a terminal may lack the sign for plus or minus
    return _PrintableStream(stream.detach(), encoding, errors, None, *settings)


def is_terminal(stream: TextIO) -> bool:
    """Whether somebody may look at a stream; a closed one is no terminal."""
    return not stream.closed and stream.isatty()


def console(*, stderr: bool = False) -> Console:
    """A console for tables, colours and bars; the strings that it is given are made printable."""
    from vmach.base.printable_console import PrintableConsole  # late: it loads rich

    stream = sys.stderr if stderr else sys.stdout
    if isinstance(stream, _PrintableStream):
        return PrintableConsole(file=cast(TextIO, _Controlling(stream)))
    return PrintableConsole(file=stream)
