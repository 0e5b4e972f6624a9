"""T, D and M6, and the tool's radius: G40, G41, G42 with G450 and G451."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gcode.errors import ProgramError

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.block_words import Words
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["ToolWords"]

#: G451 goes to the intersection in corners that turn less (machine data 20210, as delivered), rad
_CORNER_LIMIT = math.radians(100.0)


class ToolWords:
    """The tool of a program.

    Parameters
    ----------
    reader : SinumerikReader
    """

    def __init__(self, reader: SinumerikReader) -> None:
        self.reader = reader
        self.edge = 1  #: D: cutting edge, 0 takes the tool offset off

    def change(self, words: Words) -> None:
        """T, D and M6."""
        values, reader = dict(words), self.reader
        if "T" in values:
            reader.execute(f"t{values['T']:.0f}")
        edge = self.edge
        if "D" in values:
            if values["D"] not in (0.0, 1.0):
                raise ProgramError(f"cutting edge D{values['D']:g}", accepted="D0 D1")
            edge = int(values["D"])
        changed = any(letter == "M" and value == 6 for letter, value in words)
        if changed:
            reader.execute("m6")
        if changed or edge != self.edge:
            self.edge = edge
            tool = reader.controller.tool
            reader.execute(f"g43h{tool}" if edge and tool else "g49")

    def approach(self, word: str) -> None:
        """NORM and KONT, which differ only where the tool starts or ends behind the contour.

        Function Manual Basic Functions 6FC5397-0BP40-2BA0, section 18.5.3.
        """
        self.reader.controller.use(word)
        self.reader.controller.start_up = "in front" if word == "KONT" else "A"

    def side(self, words: Words, g_codes: list[float]) -> None:
        """G40, G41, G42 with the radius of the tool in the spindle."""
        c = self.reader.controller
        if {450.0, 451.0} & set(g_codes):
            c.round_corners_from = _CORNER_LIMIT if 451.0 in g_codes else 0.0
        for code in (40.0, 41.0, 42.0):
            if code not in g_codes:
                continue
            words.remove(("G", code))
            side = {40.0: 0, 41.0: 1, 42.0: -1}[code]
            if side == c.side:
                continue
            if side and c.side:
                self.reader.execute("g40")
            self.reader.execute(f"g{code:.0f}d{c.tool}" if side else "g40")
