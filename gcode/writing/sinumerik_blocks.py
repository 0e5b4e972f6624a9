"""Sinumerik blocks written out as plain ones: G0 to G3 and G4."""

from __future__ import annotations

import re
from bisect import bisect_right
from functools import cached_property

import numpy as np

from gcode.writing.plain_blocks import PlainArc, PlainBlocks

__all__ = ["FEED_UNITS_MM", "SinumerikBlocks"]

_COMMENT = re.compile(r";.*")
_NUMBER = re.compile(r"\s*(?:/\d?\s*)?(?:N\d+\s*)?", re.IGNORECASE)
_CALL = re.compile(
    r"(?:MCALL\b|(?:CYCLE\d+|HOLES[12]|POCKET[34]|SLOT[12]|LONGHOLE)\s*\()", re.IGNORECASE
)
_MODAL_CALL = re.compile(r"MCALL\b", re.IGNORECASE)
#: a corner, or a soft approach
_WAITS = re.compile(r"\b(?:(?:RNDM?|CH[FR])\s*=|G[123]47(?!\d))", re.IGNORECASE)
_MOTION = re.compile(r"\bG0*[0-3](?!\d)|\bC(?:IP|T)\b", re.IGNORECASE)
_FEED = re.compile(r"\bF\s*(?:=|[\d.])", re.IGNORECASE)
_MACHINE = re.compile(r"\b(?:SUPA|G(?:53|153|74|75))\b", re.IGNORECASE)
#: words that go with the motion
_GONE = re.compile(
    r"\b(?:G0*[0-3]|G4[0-2]|G[123]4[78]|G34[01]|G140|CIP|CT)(?!\d)"
    r"|(?:\b|(?<=\d))(?:CR|TURN|AP|AR|RP|RNDM?|CHF|CHR|DISR|DISCL|FAD|[IJK]1|[XYZIJKF])\s*(?:=\s*\S+|[-+]?\d*\.?\d+)",
    re.IGNORECASE,
)
_UNITS = re.compile(r"\bG(7[01]0?)(?!\d)", re.IGNORECASE)
#: code -> unit of F, mm
FEED_UNITS_MM = {70.0: 1.0, 71.0: 1.0, 700.0: 25.4, 710.0: 1.0}
_DECIMALS = 12


class SinumerikBlocks(PlainBlocks):
    """Sinumerik: G0, G1, G2 and G3 with I and J."""

    def content(self, line: int) -> str:
        """A line without number and comment."""
        if not 0 < line <= len(self.source.lines):
            return ""
        text = _COMMENT.sub("", self.source.lines[line - 1])
        return text[_NUMBER.match(text).end() :].strip()

    def waits(self, line: int) -> bool:
        """A line that the line behind it goes along: a corner or soft approach; or MCALL."""
        content = self.content(line)
        return bool(_WAITS.search(content)) or bool(_MODAL_CALL.match(content))

    def says_feed(self, line: int) -> bool:
        """F."""
        return _FEED.search(self.content(line)) is not None

    def says_motion(self, line: int) -> bool:
        """G0 to G3."""
        return _MOTION.search(self.content(line)) is not None

    def is_in_machine_coordinates(self, line: int) -> bool:
        """SUPA, G53, G153, G74 and G75."""
        return _MACHINE.search(self.content(line)) is not None

    def framed(self, line: int, blocks: list[str]) -> list[str]:
        """Number, comment and the words that do not move, before the first block."""
        text = self.source.lines[line - 1]
        number, content = _NUMBER.match(text).group(), self.content(line)
        stays = "" if _CALL.match(content) else " ".join(_GONE.sub(" ", content).split())
        first = " ".join(piece for piece in (stays, *blocks[:1]) if piece)
        if not first:
            return []
        comment = _COMMENT.search(text)
        head = f"{number}{first}" + (f" {comment.group()}" if comment else "")
        return [head, *blocks[1:]]

    def straight(self, end: np.ndarray, named: list[str], feed: float | None) -> list[str]:
        """G0 or G1."""
        axes = [axis + _length(end["XYZ".index(axis)]) for axis in named]
        return [" ".join(["G0" if feed is None else "G1", *axes, *_feed(feed)])]

    def arc(self, arc: PlainArc, feed: float) -> list[str] | None:
        """G2 or G3, a helix with Z, and TURN for its further turns."""
        words = [axis + _length(v) for axis, v in zip("XY", arc.said[:2], strict=True)]
        if abs(arc.rise) > 1e-9:
            words.append("Z" + _length(arc.said[2]))
        out = (arc.centre - arc.start)[:2]
        words += [axis + _length(v) for axis, v in zip("IJ", out, strict=True)]
        further = int(np.ceil(abs(arc.sweep_rad) / (2.0 * np.pi) - 1e-9)) - 1
        words += [f"TURN={further}"] if further > 0 else []
        return [" ".join(["G3" if arc.sweep_rad > 0 else "G2", *words, *_feed(feed)])]

    def feed_unit_mm(self, line: int, unit_mm: float) -> float:
        """The unit of F, as the last of G70, G71, G700 and G710 up to the line has it."""
        at = bisect_right(self._feed_units, (line, np.inf)) - 1
        return self._feed_units[at][1] if at >= 0 else 1.0

    @cached_property
    def _feed_units(self) -> list[tuple[int, float]]:
        """Lines that change the unit of F, and to what, mm."""
        found = []
        for line in range(1, len(self.source.lines) + 1):
            codes = _UNITS.findall(self.content(line))
            if codes:
                found.append((line, FEED_UNITS_MM[float(codes[-1])]))
        return found

    def pause(self, seconds: float) -> list[str]:
        """G4 F."""
        return [f"G4 F{seconds:.6g}"]


def _length(value: float) -> str:
    text = f"{value:.{_DECIMALS}f}".rstrip("0")
    text = text + "0" if text.endswith(".") else text
    return text.removeprefix("-") if float(text) == 0.0 else text


def _feed(feed: float | None) -> list[str]:
    return [] if feed is None else [f"F{feed:.6f}".rstrip("0").rstrip(".")]
