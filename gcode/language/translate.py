"""Running a program line by line, each line translated to RS274/NGC blocks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gcode.control.interpreter import execute
from gcode.control.loop_guard import BlockBudget
from gcode.language.options import RunOptions
from gcode.motion.cutter_compensation import flush
from gcode.state.controller import Controller
from gcode.text.lexer import compact, read_block

if TYPE_CHECKING:
    from gcode.language.translated_lane import TranslatedLane
    from gcode.text.source import Source

__all__ = ["Translated", "number", "xy_words"]


#: a line of motion becomes no more blocks of RS274/NGC; a cycle does
_BLOCKS_OF_A_LINE = 20


def number(value: float) -> str:
    """Write a number so that reading gives the same value; RS274 has no exponents."""
    text = repr(float(value))
    return text if "e" not in text else f"{value:.20f}"


def xy_words(x: float, y: float) -> str:
    """A place of the XY plane as words."""
    return f"x{number(x)}y{number(y)}"


class Translated:
    """Base of the dialects whose lines become blocks.

    Parameters
    ----------
    controller : Controller
        State.
    lines : list of str
        The program.
    options : RunOptions
    """

    def __init__(self, controller: Controller, lines: list[str], options: RunOptions) -> None:
        self.controller, self.lines, self.options = controller, lines, options
        self.budget = BlockBudget(options.max_blocks)
        self.next, self.stop = 0, len(lines)
        self.ended = False
        self._free = 0  #: further blocks that the line may become before they count
        self.lane: TranslatedLane | None = None  #: obeys plain motion in compiled code

    def use_fast_lane(self, source: Source) -> None:
        """Give stretches of lines to compiled code, where the dialect has such a way."""

    def run(self) -> None:
        """Run to the end of the program."""
        controller = self.controller
        while not self.ended and (self.next < self.stop or self.leave()):
            if self.next >= self.stop or self.skip_plain():
                continue
            here = self.next
            self.next = here + 1
            controller.line = controller.record.line = self.source_line(here)
            if controller.trace is not None:
                controller.trace.begin(controller.line)
            self.budget.executed += 1
            self._free = _BLOCKS_OF_A_LINE
            self.budget.check()
            self.obey(self.lines[here])
        flush(controller)

    def leave(self) -> bool:
        """At the end of the lines: go on elsewhere, or tell that there is nothing more."""
        return False

    def source_line(self, index: int) -> int:
        """1-based line of the program's file for a line that is obeyed."""
        return index + 1

    def skip_plain(self) -> bool:
        """Obey the lines that come in another way, where there is one; tells whether it did."""
        return self.lane is not None and self.lane.skip()

    def obey(self, text: str) -> None:
        """Obey one line."""
        raise NotImplementedError

    def keep(self, why: str) -> None:
        """The line that is obeyed cannot be written anew."""
        if self.controller.trace is not None:
            self.controller.trace.keep(why)

    def execute(self, *blocks: str) -> None:
        """Hand blocks of RS274/NGC to the interpreter; those of a cycle count like others."""
        free = min(len(blocks), self._free)
        self._free -= free
        self.budget.executed += len(blocks) - free
        self.budget.check()
        for block in blocks:
            if block.strip():
                self.ended = execute(self.controller, read_block(compact(block))) or self.ended
