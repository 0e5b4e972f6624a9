"""A file as another program wrote it: its text, whatever the encoding, and its lines."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from vmach.errors import InputError
from vmach.files.text_file import read_bytes

__all__ = ["SourceFile"]

#: of a text that is read whole: a scan of some million points
_LARGEST_BYTES = 2**28
#: programs of instruments write the code page of the system that they run on
_CODE_PAGE = "cp1252"
_UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")


@dataclass(frozen=True)
class SourceFile:
    """One file, or one folder of a control's tables.

    Attributes
    ----------
    path : Path
    """

    path: Path

    @property
    def suffix(self) -> str:
        """Ending of the name, in lower case."""
        return self.path.suffix.lower()

    @cached_property
    def content(self) -> bytes:
        """The bytes; of a folder none.

        Raises
        ------
        InputError
            No such file, or not readable.
        """
        if self.path.is_dir():
            return b""
        return read_bytes(self.path, what="file to import", largest_bytes=_LARGEST_BYTES)

    @cached_property
    def text(self) -> str:
        """UTF-8, UTF-16 with its mark, or the code page 1252; line ends as ``\\n``.

        Raises
        ------
        InputError
            It is no text.
        """
        encoding = "utf-16" if self.content[:2] in _UTF16_MARKS else "utf-8-sig"
        try:
            text = self.content.decode(encoding)
        except UnicodeDecodeError:
            text = self.content.decode(_CODE_PAGE, errors="replace")
        if "\0" in text:
            raise self.error(
                "is no text: it holds zero bytes",
                line=text[: text.index("\0")].count("\n") + 1,
                accepted="a file that the instrument's program exports as text",
            )
        return text.replace("\r\n", "\n").replace("\r", "\n")

    @cached_property
    def is_text(self) -> bool:
        """Whether it can be read as text."""
        return (not self.path.is_dir() and b"\0" not in self.content[:4096]) or (
            self.content[:2] in _UTF16_MARKS
        )

    @cached_property
    def lines(self) -> list[str]:
        """Lines of the text."""
        return self.text.split("\n")

    def error(
        self, what: str, *, line: int | None = None, accepted: str, hint: str | None = None
    ) -> InputError:
        """What is wrong with the file, with the line, 1-based; the first for all of it."""
        line = line or (None if self.path.is_dir() else 1)
        return InputError(what, file=self.path, line=line, accepted=accepted, hint=hint)
