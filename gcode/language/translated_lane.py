"""Fast lane of a dialect whose lines are translated one by one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gcode.fast.fast_lane import FastLane
from gcode.fast.lane_state import hand_over, hand_over_cycle

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

    def __init__(self, reader: Translated, data: bytes, starts: np.ndarray) -> None:
        super().__init__(reader.controller, data)
        self.reader, self.starts, self.whole = reader, starts, self.data
        self.lines: Sequence[str] = reader.lines

    def code_table(self) -> CodeTable | None:
        """Codes that are obeyed here; None where the language has none."""
        return None

    def frames(self) -> None:
        """No line chooses an offset."""

    @property
    def is_here(self) -> bool:
        """The lines that run are those of the program itself, and nothing waits for them."""
        reader = self.reader
        return reader.lines is self.lines and self.controller.trace is None

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

    def hand_over(self) -> bool:
        """Put the interpreter's state into the record; False where its modes forbid it."""
        if self.controller.leaving is not None:
            return False
        hand_over_cycle(self.controller.cycle, self.state)
        return hand_over(self.controller, self.state, in_any_system=True)
