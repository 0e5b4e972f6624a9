"""Fast lane of a dialect whose lines are translated one by one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gcode.fast.fast_lane import FastLane
from gcode.fast.lane_state import hand_over, hand_over_cycle
from gcode.state.record import Call

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gcode.fast.code_table import CodeTable
    from gcode.language.translate import Translated

__all__ = ["TranslatedLane"]


class TranslatedLane(FastLane):
    """Compiled reading of the lines of one program; programs that it calls go line by line.

    Parameters
    ----------
    reader : Translated
        Of the program.
    data : bytes
        Its lines; each ends with a new line.
    starts : (lines + 1,) int64
        Offset of each line's first byte, and of the end.
    """

    tells_lines = False  #: what is obeyed can be told line by line, see `PlainLines`

    def __init__(self, reader: Translated, data: bytes, starts: np.ndarray) -> None:
        super().__init__(reader.controller, data)
        self.reader, self.starts, self.whole = reader, starts, self.data
        self.lines: Sequence[str] = reader.lines
        self._moved: list[tuple[np.ndarray, np.ndarray]] = []  # lines, and their G codes

    def code_table(self) -> CodeTable | None:
        """Codes that are obeyed here; None where the language has none."""
        return None

    def frames(self) -> None:
        """No line chooses an offset."""

    @property
    def is_here(self) -> bool:
        """The lines that run are those of the program itself, and nothing waits for them."""
        is_told = self.tells_lines or self.controller.trace is None
        return self.reader.lines is self.lines and is_told

    def skip(self) -> bool:
        """Obey the lines that come; tells whether it has."""
        reader, controller = self.reader, self.controller
        here = reader.next
        if self.pause:
            self.pause -= 1
            return False
        if not self.is_here:
            return False
        self.data = self.whole[: self.starts[reader.stop]]
        line, _ = self.run((here, int(self.starts[here])))
        if line == here:
            return False
        budget = reader.budget
        budget.executed += line - here
        last = line - 1 - max(budget.executed - budget.largest - 1, 0)
        controller.line = controller.record.line = reader.source_line(last)
        reader.next = line
        budget.check()
        return True

    def plain_part(self, _: tuple[int, int]) -> np.ndarray:
        """The program; compiled code obeys nothing but plain motion of it."""
        self._moved = []
        return self.data

    def write(self) -> None:
        """Put what has been obeyed into the record."""
        if self.controller.trace is not None:
            rows, arcs = self.output.rows[: self.state[0]["rows"]], self.output.arcs
            code = (rows["call"] != Call.TRAVERSE).astype(np.int8)
            is_arc = rows["call"] == Call.ARC
            code[is_arc] = np.where(arcs[: is_arc.sum(), 6] > 0.0, 3, 2)
            self._moved.append((rows["line"].copy(), code))
        super().write()

    def said_by(self, first: int, stop: int) -> np.ndarray:
        """G code that each of these lines says, 0-based, negative for none, (L,)."""
        said = np.full(stop - first, -1, np.int8)
        for line, code in self._moved:
            said[line - 1 - first] = code
        return said

    def hand_over(self) -> bool:
        """Put the interpreter's state into the record; False where its modes forbid it."""
        if self.controller.leaving is not None:
            return False
        hand_over_cycle(self.controller.cycle, self.state)
        return hand_over(self.controller, self.state, in_any_system=True)
