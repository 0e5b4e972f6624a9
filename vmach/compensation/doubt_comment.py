"""What is doubtful in the input, as a comment in the program that is made from it."""

from __future__ import annotations

import re
from collections.abc import Sequence

from gcode import dialect_called
from vmach.plausibility import Note

__all__ = ["with_doubts"]

#: what controls show of a comment, and far below the 255 characters of LinuxCNC's lines
_LONGEST = 120
#: a line of code that has no comment, message or text of its own, and goes on nowhere
_CODE_LINE = re.compile(r"(?!\s*(?:[%/:;]|O|BEGIN|\d+\s+BEGIN))\s*[A-Z0-9][^(;\"~]*", re.IGNORECASE)


def with_doubts(text: bytes, doubts: Sequence[Note], dialect: str) -> bytes:
    """The program with a comment at the end of its first line of code that has none.

    The line's number and its words stay. The program stays as it is where nothing is doubtful, or
    every line has a comment.

    Parameters
    ----------
    text : bytes
    doubts : sequence of Note
    dialect : str
        That the program is written in, which decides how a comment looks.
    """
    if not doubts:
        return text
    comment = _comment(doubts, dialect).encode("ascii")
    lines = text.splitlines(keepends=True)
    for number, line in enumerate(lines):
        code = line.rstrip(b"\r\n")
        if _CODE_LINE.fullmatch(code.decode("latin-1")):
            lines[number] = code.rstrip() + comment + line[len(code) :]
            break
    return b"".join(lines)


def _comment(doubts: Sequence[Note], dialect: str) -> str:
    about = "; ".join(dict.fromkeys(f"{note.kind} of {note.subject}" for note in doubts))
    said = re.sub(r"[^A-Za-z0-9 .:,-]", ",", f"doubtful input: {about}")
    if len(said) > _LONGEST:
        said = said[: _LONGEST - 3] + "..."
    begin, end = dialect_called(dialect).comment
    return f" {begin}{said}{end}"
