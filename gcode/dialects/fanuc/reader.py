"""Custom macro B: from block to block, with GOTO, WHILE, subprograms and macro calls."""

from __future__ import annotations

import re

from gcode.dialects.fanuc.block import MacroBlock, read_words
from gcode.dialects.fanuc.blocks import BlockRunner, FanucSettings
from gcode.dialects.fanuc.macro.calls import Calls
from gcode.dialects.fanuc.macro.expressions import is_null, whole_expression
from gcode.dialects.fanuc.macro.flow import MacroFlow
from gcode.dialects.fanuc.macro.line_places import LinePlaces
from gcode.dialects.fanuc.macro.line_text import COMMENT, PROGRAM, content_of
from gcode.dialects.fanuc.macro.variables import MacroVariables
from gcode.errors import ProgramError
from gcode.language.options import RunOptions
from gcode.language.translate import Translated
from gcode.state.block_values import whole
from gcode.state.controller import Controller
from gcode.text.expressions import value_of
from gcode.text.lexer import Block
from gcode.text.source import Source

__all__ = ["FanucReader"]

_SLASH = re.compile(r"\s*(?:n\s*\d+\s*)?/\s*([1-9]?)(?!\s*\d)", re.IGNORECASE)
_UNIT = re.compile(r"G\s*2[01](?![\d.])", re.IGNORECASE)
_OUTPUT = ("dprnt", "bprnt", "popen", "pclos", "setvn")
_CALL_BY_NAME = re.compile(r"m98<([^>]*)>(?:l(\d+))?")
_NO_WORDS = frozenset(("", "%", ";"))


class FanucReader(Translated):
    """Runs a Fanuc program; one file may hold several, the first is the main program."""

    settings = FanucSettings()

    def __init__(self, controller: Controller, lines: list[str], options: RunOptions) -> None:
        super().__init__(controller, lines, options)
        self.texts: list[str | None] = [None] * len(lines)
        self.variables = MacroVariables(controller, self.settings.columns,
                                        radius_in_d=self.settings.radius_in_d,
                                        counters=self.settings.counters,
                                        common_again=self.settings.common_again)  # fmt: skip
        self.blocks = BlockRunner(self, self.settings)
        self.places = LinePlaces(self)
        self.calls, self.flow = Calls(self), MacroFlow(self)
        self.fast = self.starts = None

    def run(self) -> None:
        """Run to the end of the program."""
        self.blocks.check_whole_program(self.lines)
        super().run()
        self.blocks.finish()

    def use_fast_lane(self, source: Source) -> None:
        """Give stretches of lines to compiled code."""
        from gcode.dialects.fanuc.lane import FanucLane  # loads the compiler

        self.fast, self.starts = FanucLane(self.blocks, source.data), source.line_starts

    def skip_plain(self) -> bool:
        """Let compiled code obey the lines that come; tells whether it has."""
        if self.fast is None or self.calls.modal_call is not None:
            return False
        line, _ = self.fast.run((self.next, int(self.starts[self.next])))
        if line == self.next:
            return False
        self.budget.executed += line - self.next
        self.next = line
        self.budget.check()
        return True

    def obey(self, text: str) -> None:
        """Obey one line."""
        own, calls = self.calls.own, self.calls.stack
        if self.next > own:
            if self.next == own + 1 and not calls:  # the end of the program's own text
                self.ended = True
                return
            self._obey_elsewhere(text)
        else:
            self._obey(text)

    def _obey_elsewhere(self, text: str) -> None:
        place = self.calls.of_file(self.next - 1)
        try:
            self._obey(text)
        except ProgramError as error:
            raise error.located(file=place[0], line=place[1]) from None

    def _obey(self, text: str) -> None:
        if self._is_deleted(text):
            return
        content = self.content(self.next - 1)
        if not self.flow.obey(content):
            self.statement(content)

    def _is_deleted(self, text: str) -> bool:
        """Whether the switch of an optional block skip takes the block away."""
        found = _SLASH.match(text) if "/" in text else None
        return found is not None and self.options.skips(int(found[1] or 1))

    def content(self, index: int) -> str:
        """Text of a line without block number, blanks, comments and end-of-block sign."""
        text = self.texts[index]
        if text is None:
            text = self.texts[index] = content_of(self.lines[index])
        return text

    def statement(self, content: str) -> None:
        """Obey a line that is no branch or loop."""
        if content in _NO_WORDS:
            return
        if content.startswith("%"):
            raise ProgramError(f"cannot read '{content}'", accepted="%, or % with O and a number",
                               hint="FAGOR, NUM and early SINUMERIK begin so")  # fmt: skip
        if content.startswith(_OUTPUT):
            self.controller.note(content[:5].upper(), "output to a device")
            return
        if PROGRAM.match(content):
            if self.next > 1 and not self.calls.stack:
                self._check_end(content)
            content = content[PROGRAM.match(content).end() :]
            if not content:
                return
        if content.startswith("#"):
            self._assign(content)
            return
        by_name = _CALL_BY_NAME.fullmatch(content)
        if by_name:
            self.calls.by_name(by_name[1], int(by_name[2] or 1))
            return
        block = read_words(content, self.variables)
        self._use(block)
        if block.has(65, 66, 67) or any(code in (97, 98, 99) for code in block.m):
            self.blocks.finish_corner()
            self.calls.obey(block)
        else:
            self._note_step(block)
            moved = self.blocks.obey(block)
            self.ended = self.blocks.ended
            if moved and self.calls.modal_call is not None and not self.calls.is_in_modal_call():
                self.calls.call_macro(self.calls.modal_call, modal=True)

    def says_unit(self) -> bool:
        """Whether G20 or G21 stands anywhere in the text."""
        bare = (COMMENT.sub("", line) if "(" in line else line for line in self.lines)
        return any(_UNIT.search(line) for line in bare)

    def m_codes(self) -> set[int]:
        """M codes with plain numbers anywhere in the text, but for arguments of macros."""
        found = (re.findall(r"g6[56](?![\d.]).*|m(\d+)", self.content(k))
                 for k in range(len(self.lines)))  # fmt: skip
        return {int(code) for codes in found for code in codes if code}

    def _note_step(self, block: MacroBlock) -> None:
        """Tell the trace the words as they stand in the text, before they are changed."""
        trace = self.controller.trace
        if trace is not None:
            trace.take(Block(dict(block.words), list(block.g), [float(m) for m in block.m]))

    def _use(self, block: MacroBlock) -> None:
        for code in block.g:
            self.controller.use(f"G{code:g}")
        for code in block.m:
            self.controller.use(f"M{code}")
        if block.corner is not None:
            self.controller.use(f",{block.corner[0].upper()}")

    def _check_end(self, content: str) -> None:
        """A second program begins: the main program has no end."""
        first = next((i for i in range(len(self.lines)) if PROGRAM.match(self.content(i))), 0)
        if self.next - 1 > first:
            raise ProgramError(
                f"program {content.upper()} begins before the main program ends",
                hint="end the main program with M30",
            )

    def value(self, text: str) -> float:
        """Value of an expression; NaN for <null>."""
        return value_of(whole_expression(text), self.variables)

    def number(self, text: str, what: str) -> int:
        """Whole value of an expression, zero for <null>; `what` names it in a message."""
        value = self.value(text)
        return whole(0.0 if is_null(value) else value, what)

    def _assign(self, content: str) -> None:
        left, equals, right = content[1:].partition("=")
        if not equals:
            raise ProgramError(f"cannot read '{content}'", accepted="#1=...")
        self.variables.set(self.number(left, "variable number"), self.value(right))

    def source_line(self, index: int) -> int:
        """Line of the program; what a file beside it does is done by the line that calls it."""
        return index + 1 if index < self.calls.own else self.calls.source_line
