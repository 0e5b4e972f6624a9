"""Plain motion of SINUMERIK in the fast lane."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gcode.fast.code_table import CodeTable, sinumerik_codes
from gcode.fast.sinumerik_lines import obey_sinumerik_lines
from gcode.language.translated_lane import TranslatedLane

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["SinumerikLane"]

_M_CODES = frozenset((3, 4, 5, 7, 8, 9))


class SinumerikLane(TranslatedLane):
    """Compiled reading of one program."""

    reader: SinumerikReader

    tells_lines = True

    def code_table(self) -> CodeTable:
        """Codes that are obeyed here; lines of one `PlainLines` share G90 or G91."""
        return sinumerik_codes(with_modes=self.controller.trace is None)

    @property
    def is_here(self) -> bool:
        """The lines are those of the program itself, and every word means what it says."""
        reader = self.reader
        return (
            super().is_here
            and reader.subprograms.source_line is None
            and reader.cycles.modal is None
            and reader.corners.waiting is None
            and not reader.corners.rounding
            and reader.approach.waiting is None
            and reader.frame.is_full_size
            and reader.tools.is_settled
            and not reader.variables.has_letters
            and reader.poles.plane == reader.controller.plane
            and _M_CODES.isdisjoint(reader.options.control.ignore_m)
        )

    def obey(self, data: np.ndarray, place: tuple[int, int], _: None) -> tuple[int, int]:
        """Obey lines until there is no more room; gives offset and 0-based line behind them."""
        return obey_sinumerik_lines(data, place[1], place[0], self.state, self.kept, self.words,
                                    self.codes, self.output, self.reader.units.ratio)  # fmt: skip
