"""G70, G71, G700, G710: the units of lengths, and those of feeds, which may be others.

G70 and G71 change lengths alone; F stays in the basic system, which is metric here (machine data
10240 as delivered). G700 and G710 change F too. A feed keeps its speed when the codes change.
Sources: SINUMERIK 802D sl, Operation and Programming Nibbling 6FC5398-3CP10-0BA0, section 8.2.3;
840D sl/828D, Function Manual Basic Functions 6FC5397-0BP40-2BA0, section 7.3.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from gcode.language.translate import number
from gcode.writing.sinumerik_blocks import FEED_UNITS_MM

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.block_words import Words
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["Units"]

_LENGTHS = {70.0: "g20", 700.0: "g20", 71.0: "g21", 710.0: "g21"}
_FEED = re.compile(r"(?<![a-z])f(-?\d+\.?\d*|-?\.\d+)")


class Units:
    """Units of a program.

    Parameters
    ----------
    reader : SinumerikReader
    """

    def __init__(self, reader: SinumerikReader) -> None:
        self.reader = reader
        self.feed_mm = 1.0  #: unit of F, mm

    def select(self, words: Words) -> None:
        """Obey the unit codes of a block, which hold for its own words, and take them away."""
        for code in [value for letter, value in words if letter == "G" and value in _LENGTHS]:
            words.remove(("G", code))
            self.feed_mm = FEED_UNITS_MM[code]
            self.reader.execute(_LENGTHS[code])

    @property
    def ratio(self) -> float:
        """Unit of F in units of the program's lengths."""
        return self.feed_mm / self.reader.controller.unit_mm

    def converted(self, block: str) -> str:
        """A block of RS274/NGC whose F is the program's, with F in the units of its lengths."""
        controller = self.reader.controller
        if self.ratio == 1.0 or "f" not in block or controller.feed_mode == "inverse":
            return block
        return _FEED.sub(lambda m: f"f{number(float(m[1]) * self.ratio)}", block)

    def said(self, value: float) -> float:
        """A length or a speed in the units of F, in which variables of the system are read too."""
        return value / self.ratio

    def read(self, value: float) -> float:
        """A length in the units of F, as a written variable of the system has it, in those of X."""
        return value * self.ratio
