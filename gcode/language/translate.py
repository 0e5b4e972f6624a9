"""Running a program line by line, each line translated to RS274/NGC blocks."""

from __future__ import annotations

from gcode.control.interpreter import execute
from gcode.control.loop_guard import BlockBudget
from gcode.language.options import RunOptions
from gcode.motion.cutter_compensation import flush
from gcode.state.controller import Controller
from gcode.text.lexer import compact, read_block

__all__ = ["Translated", "number"]


def number(value: float) -> str:
    """Write a number so that reading gives the same value; RS274 has no exponents."""
    text = repr(float(value))
    return text if "e" not in text else f"{value:.20f}"


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
        self.next = 0
        self.ended = False

    def run(self) -> None:
        """Run to the end of the program."""
        controller = self.controller
        while self.next < len(self.lines) and not self.ended:
            if self.skip_plain():
                continue
            here = self.next
            self.next = here + 1
            controller.line = controller.record.line = here + 1
            if controller.trace is not None:
                controller.trace.begin(here + 1)
            self.budget.executed += 1
            self.budget.check()
            self.obey(self.lines[here])
        flush(controller)

    def skip_plain(self) -> bool:
        """Obey the lines that come in another way, where there is one; tells whether it did."""
        return False

    def obey(self, text: str) -> None:
        """Obey one line."""
        raise NotImplementedError

    def execute(self, *blocks: str) -> None:
        """Hand blocks of RS274/NGC to the interpreter."""
        for block in blocks:
            if block.strip():
                self.ended = execute(self.controller, read_block(compact(block))) or self.ended
