"""Program flow: from line to line, obeyed or skipped, until the program ends."""

from __future__ import annotations

import re
from functools import lru_cache

from gcode.control.branches import BRANCHES
from gcode.control.flow_state import Flow, Label, Place, SkipReason
from gcode.control.interpreter import execute
from gcode.control.loop_guard import BlockBudget, LoopGuard
from gcode.control.loops import LOOPS
from gcode.control.subroutines import SUBROUTINES
from gcode.errors import ProgramError
from gcode.motion import cutter_compensation
from gcode.state.block_values import whole
from gcode.state.controller import Controller
from gcode.text.expressions import value_of
from gcode.text.lexer import Block, OWord, compact, is_control, read_block
from gcode.text.source import Source

__all__ = ["run_rs274"]

_HANDLERS = SUBROUTINES | LOOPS | BRANCHES

#: Loops ask for the same labels again and again.
_label = lru_cache(maxsize=1024)(Label)

#: Programs up to this size keep their read lines for the next time, bytes.
_KEEP_UP_TO = 1_000_000
_PERCENT_LINE = re.compile(rb"\s*%[ \t\r\f\v]*(?:\n|$)")


def run_rs274(
    controller: Controller, source: Source, *, block_delete: bool, max_blocks: int, fast: bool
) -> None:
    """Run RS274/NGC from the first line to M2, M30, the closing % or the end of the text.

    Raises
    ------
    ProgramError
        Where the program cannot go on; `controller.line` is the line.
    """
    runner = _Runner(controller, source, block_delete=block_delete, max_blocks=max_blocks)
    if fast:
        from gcode.fast.fast_lane import FastLane  # loads the compiler, which small programs spare

        runner.fast = FastLane(controller, source.data)
    runner.run()


class _Runner:
    """Reads the lines in the order in which they run and has each obeyed."""

    def __init__(
        self, controller: Controller, source: Source, *, block_delete: bool, max_blocks: int
    ) -> None:
        self.controller, self.data = controller, source.data
        self.block_delete = block_delete
        self.budget = BlockBudget(max_blocks)
        self.flow = Flow(controller, (0, source.mark), self.budget)
        self.guard = LoopGuard(controller)
        self.keep = len(source.data) <= _KEEP_UP_TO
        self.texts: dict[int, tuple[str, int]] = {}
        self.blocks: tuple[dict[int, Block], dict[int, Block]] = ({}, {})
        self.fast = None

    def run(self) -> None:
        """Execute until the program ends."""
        controller, flow, size = self.controller, self.flow, len(self.data)
        budget = self.budget
        record = controller.record
        opened = self._skip_percent()
        while flow.next[1] < size:
            here = flow.here = flow.next
            if self.fast is not None and flow.skip is None:
                flow.next = self.fast.run(here)
                if flow.next != here:
                    budget.executed += flow.next[0] - here[0]
                    self._check_count(flow.next[0])
                    continue
            line = here[0]
            text, end = self.texts.get(line) or self._text(here)
            flow.next = (line + 1, end)
            controller.line = record.line = line + 1
            if controller.trace is not None and flow.skip is None:
                controller.trace.begin(line + 1)
            if opened and text == "%":
                break
            budget.executed += 1
            self._check_count(line + 1)
            if not text or (self.block_delete and text[0] == "/"):
                continue
            if flow.skip is not None and not is_control(text):
                continue
            level = len(flow.frames)
            if self._obey(line, text):
                return
            if flow.next <= here and len(flow.frames) == level:
                self.guard.jumped_back(flow.next[0] + 1, level=level, executed=budget.executed,
                                       flow=flow.memory())  # fmt: skip
        self._finish()

    def _check_count(self, line: int) -> None:
        """Give up where too many lines have been obeyed, `line` (1-based) the last of them."""
        budget = self.budget
        self.controller.line = line - max(budget.executed - budget.largest - 1, 0)
        budget.check()

    def _finish(self) -> None:
        skip, frames = self.flow.skip, self.flow.frames
        if skip is not None:
            raise ProgramError(
                f"end of file while seeking O<{skip.label.name}>",
                line=skip.since[0] + 1,
                hint="the O-word has no partner",
            )
        if frames:
            raise ProgramError(f"end of file inside subroutine O<{frames[-1].label.name}>")
        cutter_compensation.flush(self.controller)

    def _skip_percent(self) -> bool:
        """Step over a first line that is only %; tells whether there is one."""
        match = _PERCENT_LINE.match(self.data, self.flow.next[1])
        if match is None:
            return False
        self.flow.next = (match.group().count(b"\n"), match.end())
        return True

    def _text(self, place: Place) -> tuple[str, int]:
        """Compact text of a line, and where the next one begins."""
        end = self.data.find(b"\n", place[1]) + 1 or len(self.data)
        self.controller.line = place[0] + 1
        result = compact(self.data[place[1] : end].decode("latin-1").rstrip("\r\n")), end
        if self.keep:
            self.texts[place[0]] = result
        return result

    def _obey(self, line: int, text: str) -> bool:
        """Obey one line; tells whether the program ends with it."""
        in_subroutine = bool(self.flow.frames)
        cache = self.blocks[in_subroutine]
        block = cache.get(line)
        if block is None:
            block = read_block(text, in_subroutine=in_subroutine)
            if self.keep:
                cache[line] = block
        if block.control is None:
            return self.flow.skip is None and execute(self.controller, block)
        self._control(block, block.control)
        return False

    def _control(self, block: Block, control: OWord) -> None:
        """Obey an O-word, M98 or M99, unless it stands among lines that are skipped."""
        keyword, skip = control.keyword, self.flow.skip
        self.flow.controls += 1
        if skip is not None and skip.reason is SkipReason.DEFINED:
            if keyword in ("sub", "program"):
                raise ProgramError("subroutine defined inside a subroutine")
            if keyword != "endsub":  # its name may ask for values that only a call gives
                return
        label = self._label(control)
        if skip is not None:
            sought = skip.reason is SkipReason.SOUGHT
            if label != skip.label or (sought and keyword not in ("sub", "program")):
                return
        _HANDLERS[keyword](self.flow, label, block)

    def _label(self, control: OWord) -> Label:
        frames = self.flow.frames
        if control.keyword == "m99":
            return frames[-1].label
        if isinstance(control.name, str):
            name = control.name
        else:
            name = str(whole(value_of(control.name, self.controller.parameters), "O-word"))
        if control.keyword in SUBROUTINES:
            return _label(name)
        return _label(name, frames[-1].label.name if frames else "")
