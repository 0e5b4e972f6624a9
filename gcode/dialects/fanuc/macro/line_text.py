"""Lines of a Fanuc program without comments and blanks, and how they begin."""

from __future__ import annotations

import re

__all__ = ["BLANKS", "COMMENT", "HEAD", "PROGRAM", "bare"]

#: block number between slashes
HEAD = re.compile(r"(?:/[1-9]?)?(?:n(\d+))?(?:/[1-9]?)?")
#: begins a program: ``O100``, ``:100``, ``O<NAME>``
PROGRAM = re.compile(r"(?:o|:)(?:(\d+)|<([^>]*)>)")
COMMENT = re.compile(r"\((?:[^()]|\([^()]*\))*\)?")
BLANKS = str.maketrans("", "", " \t\r\x0b\x0c")


def bare(line: str) -> str:
    """A line in lower case without comments and blanks."""
    return COMMENT.sub("", line).translate(BLANKS).lower()
