"""Klartext lines written out as plain ones: L, CC and C, and cycle 9 for a pause."""

from __future__ import annotations

import re

import numpy as np

from gcode.writing.plain_blocks import PlainArc, PlainBlocks

__all__ = ["KlartextBlocks"]

_HEAD = re.compile(r"\s*(\d+\s+)?")
_COMMENT = re.compile(r";.*")
_M = re.compile(r"\bM\s*(\d+)")
#: M functions that go with what is written out: calls of cycles and moves along the tool axis
_GONE_M = frozenset((89, 99, 140))
_CORNER = re.compile(r"(?:RND|CHF)\b")
_MOVES = re.compile(r"(?:L|C|CR|CT|LP|CP)\b")
_PARAMETER = re.compile(r"\s*Q\d+\s*=")
_ABOUT_POLE = re.compile(r"(?:C|CP|LP)\b")
_DECIMALS = 12
_STILL_MM = 1e-9


class KlartextBlocks(PlainBlocks):
    """Klartext: L, and C about a centre CC."""

    def content(self, line: int) -> str:
        """A line without number and comment, in upper case; empty beyond the end."""
        if not 0 < line <= len(self.source.lines):
            return ""
        text = _COMMENT.sub("", self.source.lines[line - 1])
        return text[_HEAD.match(text).end() :].strip().upper()

    def last_line(self, line: int) -> int:
        """Last line of the block that begins in a line.

        A line that ends with ``~`` goes on in the next one, and so does a list of parameters
        behind CYCL DEF without one.
        """
        has_list = self.content(line).startswith("CYCL DEF")
        while line < len(self.source.lines):
            goes_on = self.source.lines[line - 1].rstrip().endswith("~")
            if not goes_on and not (has_list and self._lists(line + 1)):
                break
            line += 1
        return line

    def _lists(self, line: int) -> bool:
        """Whether a line goes on with parameters and is no block of its own."""
        is_numbered = re.match(r"\s*\d+\s", self.source.lines[line - 1])
        return bool(_PARAMETER.match(self.content(line))) and not is_numbered

    def waits(self, line: int) -> bool:
        """Whether the line is moved along by the line behind its corner, or is that corner."""
        content = self.content(line)
        return bool(_CORNER.match(content)) or bool(
            _MOVES.match(content) and _CORNER.match(self.content(line + 1))
        )

    def sets_pole(self, line: int) -> bool:
        """Whether it is a block CC."""
        return self.content(line).startswith("CC")

    def needs_pole(self, line: int) -> bool:
        """Whether its end depends on the circle centre."""
        return bool(_ABOUT_POLE.match(self.content(line)))

    def says_feed(self, line: int) -> bool:
        """Whether it has a feed of its own that holds on."""
        return re.search(r"\bF\s*(?:[\d.Q]|AUTO)", self.content(line)) is not None

    def says_motion(self, line: int) -> bool:
        """Always: every line begins with its motion."""
        return True

    def is_in_machine_coordinates(self, line: int) -> bool:
        """M91 or M92."""
        return re.search(r"\bM\s*9[12]\b", self.content(line)) is not None

    def framed(self, line: int, blocks: list[str]) -> list[str]:
        """Blocks with the number, the comment and the M functions of the line that they replace."""
        text = self.source.lines[line - 1]
        number = _HEAD.match(text)[1] or ""
        codes = [code for code in _M.findall(self.content(line)) if int(code) not in _GONE_M]
        first = [f"M{code}" for code in codes if int(code) in (3, 4, 7, 8, 13, 14)]
        last = [f"M{code}" for code in codes if int(code) not in (3, 4, 7, 8, 13, 14)]
        blocks = [*first, *blocks, *last]
        comment = _COMMENT.search(text)
        if comment is not None and blocks:
            blocks[0] += f" {comment.group()}"
        return [number + block for block in blocks]

    def straight(self, end: np.ndarray, named: list[str], feed: float | None) -> list[str]:
        """A line to a place, X Y Z of which those in `named` are said; rapid without a feed."""
        axes = [axis + _signed(end["XYZ".index(axis)]) for axis in named]
        return [" ".join(["L", *axes, "R0", _feed(feed)])]

    def arc(self, arc: PlainArc, feed: float) -> list[str] | None:
        """An arc about a centre CC; None for a helix that the control does not read so."""
        rises, turn = abs(arc.rise) > _STILL_MM, 2.0 * np.pi
        if rises and (self.options.get("helix") != "C" or abs(arc.sweep_rad) > turn + 1e-9):
            return None
        axes = "XYZ" if rises else "XY"
        place = [axis + _signed(v) for axis, v in zip(axes, arc.end, strict=False)]
        pole = [axis + _signed(v) for axis, v in zip("XY", arc.centre[:2], strict=True)]
        sense = "DR+" if arc.sweep_rad > 0 else "DR-"
        return [" ".join(["CC", *pole]), " ".join(["C", *place, sense, _feed(feed)])]

    def feed_unit_mm(self, line: int, unit_mm: float) -> float:
        """F counts mm/min, or 0.1 inch/min."""
        return unit_mm if unit_mm == 1.0 else unit_mm / 10.0

    def pause(self, seconds: float) -> list[str]:
        """A dwell."""
        return ["CYCL DEF 9.0 DWELL TIME", f"CYCL DEF 9.1 DWELL {seconds:.6g}"]


def _signed(value: float) -> str:
    text = f"{value:+.{_DECIMALS}f}".rstrip("0")
    return text + "0" if text.endswith(".") else text


def _feed(feed: float | None) -> str:
    return "FMAX" if feed is None else f"F{feed:.6f}".rstrip("0").rstrip(".")
