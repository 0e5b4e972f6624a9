"""RND and CHF: a line or arc waits for the next one, and their corner is broken.

Source: HEIDENHAIN TNC 640, User's Manual for Klartext Programming, "Inserting a chamfer between two
straight lines", "Corner rounding RND".
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.parameters import NUMBER
from gcode.errors import ProgramError
from gcode.geometry.corners import Piece, broken_corner
from gcode.language.translate import number, xy_words

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["KlartextCorners", "WaitingPiece"]

_CORNER = re.compile(rf"(RND|CHF)\s*R?\s*({NUMBER})(?:\s*F\s*({NUMBER}))?")


@dataclass(frozen=True)
class WaitingPiece:
    """A line or arc at feed whose end waits for the corner behind it."""

    piece: Piece
    start: tuple[float, ...]  #: X Y Z A B C
    end: tuple[float, ...]
    feed: str  #: F word
    line: int
    after: tuple[str, ...] = ()  #: M functions at its end

    def block(self, end: tuple[float, float]) -> str:
        """The move to a place before its end."""
        code = {0: "g1", 1: "g3", -1: "g2"}[self.piece.sense]
        text = f"{code}{xy_words(end[0], end[1])}"
        if self.end[2] != self.start[2]:
            text += f"z{number(self.end[2])}"
        if self.piece.centre is not None:
            x, y = self.piece.centre
            text += f"i{number(x - self.start[0])}j{number(y - self.start[1])}"
        return text + self.feed


class KlartextCorners:
    """What waits for a corner.

    Parameters
    ----------
    reader : KlartextReader
    """

    def __init__(self, reader: KlartextReader) -> None:
        self.reader = reader
        self.waiting: WaitingPiece | None = None
        self.corner: tuple[str, float, str] | None = None  #: RND or CHF, its size and F word

    def define(self, content: str) -> None:
        """RND R5, CHF 5: the piece before has waited for it."""
        found = _CORNER.fullmatch(content)
        if found is None:
            raise ProgramError(f"cannot read '{content}'", accepted="RND R5 or CHF 5")
        if self.waiting is None:
            raise ProgramError(
                f"{found[1]} behind anything but a line L or an arc C, CR at feed is not read",
                accepted="lines and arcs",
            )
        value, scale = self.reader.parameters.number, self.reader.frames.scaling.of_radii
        feed = "" if found[3] is None else f"f{number(value(found[3]))}"
        self.corner = (found[1], value(found[2]) * scale, feed)

    def is_next(self, words: str = "RND|CHF") -> bool:
        """Whether RND or CHF stands in the next line."""
        reader = self.reader
        return reader.next < len(reader.lines) and bool(
            re.match(rf"(?:{words})\b", reader.content(reader.next))
        )

    def go_towards(self, following: Piece | None) -> bool:
        """Go along the piece that waits and round its corner; tells whether there was one."""
        held, corner = self.waiting, self.corner
        self.waiting = self.corner = None
        if held is None:
            return False
        if corner is None or following is None:
            raise ProgramError("RND or CHF needs a line or arc at feed behind it")
        kind, size, feed = corner
        broken = broken_corner(held.piece, following, size, chamfer=kind == "CHF")
        begin, corners = held.end[:2], []
        if broken is not None:
            begin, end = broken.begin, xy_words(broken.end[0], broken.end[1])
            turn = f"g{3 if broken.sense > 0 else 2}{end}r{number(size)}"
            corners = [f"{turn}{feed}" if kind == "RND" else f"g1{end}{feed}"]
        with self.reader.controller.told_as(held.line):
            self.reader.execute(held.block(begin), *held.after, *corners)
        return True
