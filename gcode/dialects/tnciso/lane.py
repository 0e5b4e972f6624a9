"""Plain motion of a TNC program in DIN/ISO in the fast lane, as the Klartext that it stands for."""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING

import numpy as np

from gcode.dialects.heidenhain.lane import KlartextLane

if TYPE_CHECKING:
    from gcode.dialects.tnciso.reader import TncIsoReader

__all__ = ["TncIsoLane"]


class TncIsoLane(KlartextLane):
    """Compiled reading of one program."""

    tells_lines = False  # blocks are those of Klartext, whose lines are others

    def __init__(self, reader: TncIsoReader) -> None:
        # upper case may leave Latin-1; compiled code takes no line with such a letter
        texts = [text.encode("latin-1", "replace") + b"\n" for text in reader.lines]
        starts = np.fromiter(accumulate(map(len, texts), initial=0), np.int64)
        super().__init__(reader, b"".join(texts), starts)
        #: 1-based line of the file for each of Klartext
        self.own_lines = np.array([line for _, line in reader.translation.lines], np.int32) + 1

    def write(self) -> None:
        """Put what has been obeyed into the record, with the lines of the file."""
        s, out = self.state[0], self.output
        for table, count in ((out.rows, s["rows"]), (out.events, s["events"])):
            table["line"][:count] = self.own_lines[table["line"][:count] - 1]
        out.notes[: s["notes"], 0] = self.own_lines[out.notes[: s["notes"], 0] - 1]
        super().write()
