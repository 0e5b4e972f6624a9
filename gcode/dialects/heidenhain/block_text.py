"""Blocks of Klartext as they are obeyed: without number, comment and structure, in upper case."""

from __future__ import annotations

import re
from collections.abc import Sequence

__all__ = ["bare", "joined_blocks", "key_word"]

_KEY_WORD = re.compile(
    r"CYCL DEF\s*\d+|CYCL CALL(?:\s+(?:POS|PAT))?|FN\s*\d+|(?:APPR|DEP)\s+\w+|PLANE\s+\w+"
    r"|CALL (?:PGM|LBL)|TOOL (?:CALL|DEF)|BLK FORM|(?:BEGIN|END) PGM|PATTERN DEF"
    r"|Q[LR]?(?=\d)|[A-Z]+"
)
_COMMA = re.compile(r"(?<=\d),(?=\d)")
_NUMBER = re.compile(r"^\d+(?:\s+|$)")
#: their further lines are Q parameters or places, each with a comment of its own
_LISTS = re.compile(r"\s*/?\s*\d*\s*/?\s*(?:CYCLE?\s+DEF|PATTERN\s+DEF|TCH\s+PROBE)", re.IGNORECASE)


def bare(line: str) -> str:
    """A line without number and comment; decimal commas become points."""
    text = re.sub(r";.*", "", line).replace("~", " ").strip().upper()
    slash = "/" if text.startswith("/") else ""  # before the number of the block, or behind it
    text = slash + _COMMA.sub(".", _NUMBER.sub("", text.removeprefix("/").lstrip()))
    return "CYCL" + text[5:] if text.startswith("CYCLE ") else text


def key_word(content: str) -> str:
    """By what a block is counted: ``L``, ``CYCL DEF 200``, ``FN 9``, ``APPR LT``."""
    found = _KEY_WORD.match(content)
    if found is None:
        return content[:12]
    return re.sub(r"(?<=[A-Z])\s*(?=\d)", " ", found.group())


def joined_blocks(lines: Sequence[str]) -> dict[int, str]:
    """Blocks of more than one line, by their first line; nothing is left of the others.

    A line that ends with ``~`` goes on in the next one. Lists of parameters are left as they are.
    """
    found: dict[int, str] = {}
    index = 0
    while index < len(lines):
        first = index
        while lines[index].rstrip().endswith("~") and index + 1 < len(lines):
            index += 1
        if index > first and not _LISTS.match(lines[first]):
            pieces = [line.rstrip().removesuffix("~") for line in lines[first : index + 1]]
            found[first] = bare(" ".join(pieces))
            found |= dict.fromkeys(range(first + 1, index + 1), "")
        index += 1
    return found
