"""Tools as the comments of a program describe them: ``(T1 D=6. CR=3. - ball end mill)``."""

from __future__ import annotations

import re
from dataclasses import dataclass

__all__ = ["SaidTool", "said_tools"]

_COMMENT = re.compile(
    r"^\s*(?:\d+\s+)?[;(*]\s*#?T?(\d+)\b[^\n]*?\bD\s*=\s*([\d.]+)(?:[^\n]*?\bCR\s*=\s*([\d.]+))?"
    r"([^\n]*)",
    re.IGNORECASE | re.MULTILINE,
)
_DRILL = re.compile(r"\b(?:drill|bohrer|foret)", re.IGNORECASE)


@dataclass(frozen=True)
class SaidTool:
    """A tool of a comment; lengths in the unit of the program."""

    shape: str
    diameter: float
    corner_radius: float = 0.0


def said_tools(text: str) -> dict[int, SaidTool]:
    """Tools by number; the first comment on each counts."""
    found: dict[int, SaidTool] = {}
    for number, diameter, corner, rest in _COMMENT.findall(text):
        try:
            size, radius = float(diameter), float(corner or 0.0)
        except ValueError:
            continue
        if size <= 0.0 or int(number) in found:
            continue
        shape = "flat"
        if _DRILL.search(rest):
            shape = "drill"
        elif radius > 0.0:
            shape = "ball" if abs(2.0 * radius - size) < 1e-6 * size else "bull"
        found[int(number)] = SaidTool(shape, size, radius)
    return found
