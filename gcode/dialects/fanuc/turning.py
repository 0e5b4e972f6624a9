"""Turning programs: letters and numbers as in milling, but other words for other axes."""

from __future__ import annotations

import re

from gcode.errors import ProgramError

__all__ = ["check_milling", "looks_like_turning"]

_COMMENT = re.compile(r"\([^)]*\)?|;.*")
#: marks of a lathe, each with what it is called
_MARKS = {
    "T0101": re.compile(r"T0?\d0?\d(?:0\d|\d\d)\b(?!.*M0?6(?!\d))", re.IGNORECASE),
    "G50 S": re.compile(r"G50\s*S\d", re.IGNORECASE),
    "G96": re.compile(r"G96(?!\d)", re.IGNORECASE),
    "U W": re.compile(r"(?:^|[\s\d.])[UW]\s*-?\.?\d", re.IGNORECASE),
    "G70 to G76 P Q": re.compile(
        r"G7[0-36]\s*.*(?:P\d+\s*Q\d+|U-?[\d.]+\s*(?:R|W))", re.IGNORECASE
    ),
    "G28 U": re.compile(r"G28\s*[UW]", re.IGNORECASE),
}
_Y = re.compile(r"Y\s*[-+.\d#\[]", re.IGNORECASE)
_ENOUGH = 2


def looks_like_turning(lines: list[str]) -> dict[str, int]:
    """Marks of a lathe with their first lines (1-based); empty for a milling program."""
    found: dict[str, int] = {}
    for number, line in enumerate(lines, 1):
        text = _COMMENT.sub("", line)
        if _Y.search(text):
            return {}
        for name, pattern in _MARKS.items():
            if name not in found and pattern.search(text):
                found[name] = number
    return found if len(found) >= _ENOUGH else {}


def check_milling(lines: list[str]) -> None:
    """Raise ProgramError for a turning program."""
    found = looks_like_turning(lines)
    if found:
        raise ProgramError(
            f"a turning program: {', '.join(found)}, and no Y",
            line=min(found.values()),
            accepted="milling with three axes",
        )
