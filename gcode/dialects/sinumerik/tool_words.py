"""T, D and M6, and the tool's radius: G40, G41, G42 with G450 and G451.

D is a cutting edge of the tool in the spindle. With flat D numbers it chooses an offset on its own,
whatever T says: Function Manual Basic Functions 08/2005, 6FC5397-0BP10-0BA0, W1 section 2.2
(machine data 18102).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gcode.errors import ProgramError
from gcode.state.tools import ToolEntry

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
        self.is_flat = reader.options.control.options.get("d_numbers") == "flat"
        self.edge = 0 if self.is_flat else 1  #: D; 0 takes the tool offset off
        self._has_d = True  #: D was said since the last T
        self._wants_d = False  #: a tool was changed, and nobody said its D

    @property
    def offset(self) -> int:
        """Row of the offset memory that length and radius come from; 0 for none."""
        return self.edge if self.is_flat else self.reader.controller.tool if self.edge else 0

    @property
    def entry(self) -> ToolEntry:
        """Length and radius that cycles and variables of the system ask for."""
        c = self.reader.controller
        return c.offsets.get(self.edge if self.is_flat else c.tool, ToolEntry())

    @property
    def is_settled(self) -> bool:
        """No move has to be refused for want of a D."""
        return not self._wants_d

    def change(self, words: Words) -> None:
        """T, D and M6."""
        values, reader = dict(words), self.reader
        if "T" in values:
            reader.execute(f"t{values['T']:.0f}")
            self._has_d = False
        edge = self._edge(words)
        changed = any(letter == "M" and value == 6 for letter, value in words)
        if changed:
            reader.execute("m6")
            self._wants_d = self.is_flat and not self._has_d
        if changed or edge != self.edge:
            self.edge = edge
            reader.execute(f"g43h{self.offset}" if self.offset else "g49")

    def _edge(self, words: Words) -> int:
        """D of a block, or the one that is in force."""
        values = dict(words)
        if "D" not in values:
            moves = bool(values.keys() & {"X", "Y", "Z"}) and ("G", 53.0) not in words
            if self._wants_d and moves:
                raise ProgramError("a tool is called without D, and D numbers are flat",
                                   accepted="D with the number of its offset")  # fmt: skip
            return self.edge
        number, self._has_d, self._wants_d = values["D"], True, False
        if self.is_flat and number in (0.0, *self.reader.controller.offsets):
            return int(number)
        if self.is_flat:
            raise ProgramError(f"there is no offset D{number:g}",
                               accepted="D0 and the numbers of tools and offsets")  # fmt: skip
        if number not in (0.0, 1.0):
            raise ProgramError(
                f"cutting edge D{number:g}", accepted="D0 D1",
                hint="where D chooses an offset whatever T says, [control] options = "
                '{ d_numbers = "flat" }',
            )  # fmt: skip
        return int(number)

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
            row = self.offset if self.is_flat else c.tool
            self.reader.execute(f"g{code:.0f}d{row}" if side else "g40")
