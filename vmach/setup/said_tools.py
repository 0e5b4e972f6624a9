"""Tools as the comments of a program describe them: ``(T1 D=6. CR=3. - ball end mill)``."""

from __future__ import annotations

import re
from dataclasses import dataclass

__all__ = ["SaidTool", "said_tools"]

_NUMBER = re.compile(r"[\s;(*]*(?P<named>#|T)?\s*(?P<number>\d+)\b", re.IGNORECASE)
_CALLED = re.compile(r"(?<![A-Z])T\s*(\d+)", re.IGNORECASE)
_SIZE = r"\s*[=:]?\s*(?P<size>\d*[.,]?\d+)"
_STATED = re.compile(r"\bD\s*=\s*(?P<size>\d*[.,]?\d+)", re.IGNORECASE)
#: as people write it; a plain D or R is one only where a kind of tool stands beside it, no offset
_LOOSE = (
    re.compile(rf"(?:\bDIAM?(?:ETER)?\b\.?|[Øø⌀]){_SIZE}", re.IGNORECASE),
    re.compile(r"(?<![\w.,])(?P<size>\d*[.,]?\d+)\s*(?P<mm>MM)\b", re.IGNORECASE),
    re.compile(r"\bD\s*(?P<size>\d*[.,]?\d+)", re.IGNORECASE),
)
_CORNER = re.compile(r"\bCR\s*=\s*(\d*[.,]?\d+)|\bR\s*=?\s*(\d*[.,]?\d+)", re.IGNORECASE)
_KINDS = re.compile(
    r"mill|drill|cutter|ball|bull|reamer|fr[äa]e?s|bohrer|kugel|foret|fraise|broca|fresa",
    re.IGNORECASE,
)
_DRILL = re.compile(r"\b(?:drill|bohrer|foret|broca)|(?:bohrer)\b", re.IGNORECASE)
_BALL = re.compile(r"\b(?:ball|kugel)", re.IGNORECASE)
_OFFSET = re.compile(r"\bH\s*\d", re.IGNORECASE)


@dataclass(frozen=True)
class SaidTool:
    """A tool of a comment; lengths in the unit of the program, or in mm where the comment says so.

    Attributes
    ----------
    shape : str
        As in a job file.
    diameter, corner_radius : float
    is_mm : bool
    """

    shape: str
    diameter: float
    corner_radius: float = 0.0
    is_mm: bool = False


def said_tools(text: str) -> dict[int, SaidTool]:
    """Tools by number; the first comment on each counts."""
    found: dict[int, SaidTool] = {}
    for line in text.split("\n"):
        code, mark, comment = _parted(line)
        told = _NUMBER.match(comment) if mark else None
        called = _CALLED.search(code) if mark else None
        if told is None and called is None:
            continue
        number = int(told["number"] if told else called[1])  # type: ignore[index]
        is_named = called is not None or bool(told and told["named"])
        tool = _tool(comment[told.end() :] if told else comment, is_loose=is_named)
        if tool is not None:
            found.setdefault(number, tool)
    return found


def _parted(line: str) -> tuple[str, str, str]:
    """A line before its comment, what opens the comment, and the comment."""
    at = min((k for mark in "(;*" if (k := line.find(mark)) >= 0), default=len(line))
    return line[:at], line[at : at + 1], line[at + 1 :]


def _tool(comment: str, *, is_loose: bool) -> SaidTool | None:
    stated = _STATED.search(comment)
    if stated is None and is_loose and _KINDS.search(comment) and not _OFFSET.search(comment):
        stated = next((found for form in _LOOSE if (found := form.search(comment))), None)
    if stated is None or not (size := _number(stated["size"])):
        return None
    corner = _CORNER.search(comment)
    radius = _number(corner[1] or corner[2]) if corner else 0.0
    is_mm = bool(stated.groupdict().get("mm"))
    if _DRILL.search(comment):
        return SaidTool("drill", size, is_mm=is_mm)
    if _BALL.search(comment) or (radius and abs(2.0 * radius - size) < 1e-6 * size):
        return SaidTool("ball", size, 0.5 * size, is_mm)
    if 0.0 < radius < 0.5 * size:
        return SaidTool("bull", size, radius, is_mm)
    return SaidTool("flat", size, is_mm=is_mm)


def _number(text: str) -> float:
    return float(text.replace(",", "."))
