"""IF, GOTO, WHILE, DO and END of custom macro B."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from gcode.control.loop_guard import LoopGuard
from gcode.dialects.fanuc.macro.expressions import is_null
from gcode.errors import ProgramError

if TYPE_CHECKING:
    from gcode.dialects.fanuc.reader import FanucReader

__all__ = ["MacroFlow"]


class MacroFlow:
    """Branches and loops of a program.

    Parameters
    ----------
    reader : FanucReader
    """

    def __init__(self, reader: FanucReader) -> None:
        self.reader = reader
        self._guard = LoopGuard(reader.controller)
        self._forms = (
            ("IF", re.compile(r"if(\[.*\])go(?:to)?(.+)"), self._if_goto),
            ("IF THEN", re.compile(r"if(\[.*\])th(?:en)?(.+)"), self._if_then),
            ("GOTO", re.compile(r"go(?:to)?([\d#\[].*)"), self._goto),
            ("WHILE", re.compile(r"wh(?:ile)?(\[.*\])do(\d+)"), self._while),
            ("DO", re.compile(r"do(\d+)"), lambda _: None),
            ("END", re.compile(r"en(?:d)?(\d+)"), self._end),
        )

    def obey(self, content: str) -> bool:
        """Obey a statement of flow; tells whether the line is one."""
        if content[:1] not in ("i", "g", "w", "d", "e"):
            return False
        for name, pattern, action in self._forms:
            match = pattern.fullmatch(content)
            if match:
                self.reader.controller.use(name)
                self.reader.blocks.finish_corner()
                action(*match.groups())
                return True
        if content.startswith("if["):
            raise ProgramError("IF without GOTO and without THEN",
                               accepted="IF[#1EQ2]GOTO10, IF[#1EQ2]THEN#3=4")  # fmt: skip
        return False

    def _if_goto(self, condition: str, target: str) -> None:
        if self._is_true(condition):
            self._goto(target)

    def _if_then(self, condition: str, statement: str) -> None:
        if self._is_true(condition):
            self.reader.statement(statement)

    def _is_true(self, condition: str) -> bool:
        value = self.reader.value(condition)
        return not is_null(value) and value != 0.0

    def _goto(self, target: str) -> None:
        wanted = self.reader.number(target, "GOTO")
        self.jump(self.labelled(wanted, "GOTO"))

    def labelled(self, wanted: int, what: str) -> int:
        """Line of a block number: forwards from here to the end, then from the beginning."""
        found = self.reader.places.block(wanted, self.reader.next, *self.program_lines())
        if found is None:
            raise ProgramError(f"{what}{wanted}: no block N{wanted} in this program")
        return found

    def jump(self, index: int) -> None:
        """Go on at another line of the running program."""
        if index < self.reader.next:
            reader, calls = self.reader, self.reader.calls.stack
            self._guard.jumped_back(
                index + 1, level=len(calls), executed=reader.budget.executed,
                flow=(calls, reader.variables.locals, reader.variables.common,
                      reader.blocks.memory()),
            )  # fmt: skip
        self.reader.next = index

    def program_lines(self) -> tuple[int, int]:
        """First line of the running program, and the line at which the next begins."""
        calls = self.reader.calls.stack
        return self.reader.places.around(calls[-1].program if calls else 0)

    def _while(self, condition: str, label: str) -> None:
        if self._is_true(condition):
            return
        stop = self.program_lines()[1]
        for index in range(self.reader.next, stop):
            if re.fullmatch(rf"en(?:d)?{label}", self.reader.content(index)):
                self.reader.next = index + 1
                return
        raise ProgramError(f"DO{label} without END{label}")

    def _end(self, label: str) -> None:
        start = self.program_lines()[0]
        for index in range(self.reader.next - 2, start - 1, -1):
            if re.fullmatch(rf"(?:wh(?:ile)?\[.*\])?do{label}", self.reader.content(index)):
                self.jump(index)
                return
        raise ProgramError(f"END{label} without DO{label}")
