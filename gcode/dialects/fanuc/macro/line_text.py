"""Lines of a Fanuc program without comments and blanks, and how they begin."""

from __future__ import annotations

import re

__all__ = ["BLANKS", "COMMENT", "HEAD", "PROGRAM", "bare", "content_of"]

#: block number between slashes
HEAD = re.compile(r"(?:/[1-9]?)?(?:n(\d+))?(?:/[1-9]?)?")
#: begins a program: ``O100``, ``:100``, ``O<NAME>``
PROGRAM = re.compile(r"(?:o|:)(?:(\d+)|<([^>]*)>)")
COMMENT = re.compile(r"\((?:[^()]|\([^()]*\))*\)?")
_LEADER = re.compile(r"^%(?=[o:]\d)")  #: of a tape; the program's number may follow
BLANKS = str.maketrans("", "", " \t\r\x0b\x0c")


def bare(line: str) -> str:
    """A line in lower case without comments and blanks."""
    return COMMENT.sub("", line).translate(BLANKS).lower()


def content_of(line: str) -> str:
    """A line in lower case without block number, blanks, comments and end-of-block sign."""
    text = COMMENT.sub("", line) if "(" in line else line
    text = text.split(";")[0].translate(BLANKS).lower()
    return _LEADER.sub("", text[HEAD.match(text).end() :])
