"""Sinumerik blocks written out as plain ones: G0 to G3 with absolute ends, and G4."""

from __future__ import annotations

import re

import numpy as np

from gcode.writing.plain_blocks import PlainBlocks

__all__ = ["SinumerikBlocks"]

_COMMENT = re.compile(r";.*")
_NUMBER = re.compile(r"\s*(?:/\d?\s*)?(?:N\d+\s*)?", re.IGNORECASE)
_CALL = re.compile(
    r"(?:MCALL\b|(?:CYCLE\d+|HOLES[12]|POCKET[34]|SLOT1|LONGHOLE)\s*\()", re.IGNORECASE
)
_MODAL_CALL = re.compile(r"MCALL\b", re.IGNORECASE)
_CORNER = re.compile(r"\b(?:RND|CH[FR])\s*=", re.IGNORECASE)
_MOTION = re.compile(r"\bG0*[0-3](?!\d)|\bC(?:IP|T)\b", re.IGNORECASE)
_FEED = re.compile(r"\bF\s*(?:=|[\d.])", re.IGNORECASE)
_MACHINE = re.compile(r"\b(?:SUPA|G(?:53|153|74|75))\b", re.IGNORECASE)
#: words that go with the motion
_GONE = re.compile(
    r"\b(?:G0*[0-3]|G4[0-2]|G9[01]|CIP|CT)(?!\d)"
    r"|(?:\b|(?<=\d))(?:CR|TURN|AP|AR|RP|RND|CHF|CHR|[IJK]1|[XYZIJKF])\s*(?:=\s*\S+|[-+]?\d*\.?\d+)",
    re.IGNORECASE,
)
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
        """A line with a corner, which the line behind it goes along; or MCALL."""
        content = self.content(line)
        return bool(_CORNER.search(content)) or bool(_MODAL_CALL.match(content))

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
        """G0 or G1 in G90."""
        axes = [axis + _length(end["XYZ".index(axis)]) for axis in named]
        return [" ".join(["G0" if feed is None else "G1", *axes, *_feed(feed)])]

    def arc(
        self, start: np.ndarray, end: np.ndarray, centre: np.ndarray, feed: float, *,
        counter_clockwise: bool,
    ) -> list[str] | None:  # fmt: skip
        """G2 or G3, a helix with Z."""
        words = [axis + _length(v) for axis, v in zip("XY", end[:2], strict=True)]
        if abs(end[2] - start[2]) > 1e-9:
            words.append("Z" + _length(end[2]))
        words += [axis + _length(v) for axis, v in zip("IJ", (centre - start)[:2], strict=True)]
        return [" ".join(["G3" if counter_clockwise else "G2", *words, *_feed(feed)])]

    def pause(self, seconds: float) -> list[str]:
        """G4 F."""
        return [f"G4 F{seconds:.6g}"]


def _length(value: float) -> str:
    text = f"{value:.{_DECIMALS}f}".rstrip("0")
    text = text + "0" if text.endswith(".") else text
    return text.removeprefix("-") if float(text) == 0.0 else text


def _feed(feed: float | None) -> list[str]:
    return [] if feed is None else [f"F{feed:.6f}".rstrip("0").rstrip(".")]
