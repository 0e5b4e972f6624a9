"""Program flow: lines, O-words, subroutine calls, M98 and M99."""

from __future__ import annotations

import re
from dataclasses import dataclass

from gcode import cutter_compensation
from gcode.block_values import whole
from gcode.errors import ProgramError
from gcode.expressions import value_of
from gcode.interpreter import execute, restore_modes
from gcode.lexer import Block, OWord, compact, is_control, read_block
from gcode.loop_guard import LoopGuard, check_count
from gcode.source import Source
from gcode.state import Controller

__all__ = ["run_rs274"]

_LEVELS = 10  #: nesting of subroutine calls that the controller allows
_LOCAL = frozenset(("do", "while", "repeat", "if", "elseif", "else", "endif", "break", "continue",
                    "endwhile", "endrepeat"))  # fmt: skip


#: 0-based line and byte offset of its first byte.
Place = tuple[int, int]


#: Programs up to this size keep their read lines for the next time, bytes.
_KEEP_UP_TO = 1_000_000
_OPENING = re.compile(rb"\s*%[ \t\r\f\v]*(?:\n|$)")


@dataclass
class _Label:
    """Where a subroutine, a loop or an IF begins."""

    keyword: str
    place: Place
    repeats: int | None = None


@dataclass
class _Frame:
    """One call in progress."""

    name: str
    keyword: str  #: call or m98
    return_to: Place
    arguments: list[float]
    repeats: int = 1


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
        from gcode.fast_lane import FastLane  # loads the compiler, which small programs spare

        runner.fast = FastLane(controller, source.data)
    runner.run()


class _Runner:
    """Interpreter of program flow.

    A place in the program is (0-based line, byte offset of its first byte).
    """

    def __init__(
        self, controller: Controller, source: Source, *, block_delete: bool, max_blocks: int
    ) -> None:
        self.controller, self.data = controller, source.data
        self.block_delete, self.max_blocks = block_delete, max_blocks
        self.guard = LoopGuard(controller)
        self.keep = len(source.data) <= _KEEP_UP_TO
        self.texts: dict[int, tuple[str, int]] = {}
        self.blocks: tuple[dict[int, Block], dict[int, Block]] = ({}, {})
        self.next: Place = (0, source.mark)
        self.fast = None
        self.frames: list[_Frame] = []
        self.labels: dict[str, _Label] = {}
        self.skip_to: str | None = None  #: label at which execution goes on
        self.skip_from: Place = (0, 0)
        self.seeking_sub = False
        self.defining: str | None = None
        self.if_done = False
        self.leaving = self.continuing = False

    def run(self) -> None:
        """Execute until the program ends."""
        controller, record, size = self.controller, self.controller.record, len(self.data)
        opened = self._skip_percent()
        executed = 0
        while self.next[1] < size:
            here = self.next
            if self.fast is not None and self.skip_to is None:
                self.next = self.fast.run(here)
                if self.next != here:
                    executed += self.next[0] - here[0]
                    self._check_count(executed, self.next[0])
                    continue
            line = here[0]
            text, end = self.texts.get(line) or self._text(here)
            self.next = (line + 1, end)
            controller.line = record.line = line + 1
            if controller.trace is not None and self.skip_to is None:
                controller.trace.begin(line + 1)
            if opened and text == "%":
                break
            executed += 1
            self._check_count(executed, line + 1)
            if not text or (self.block_delete and text[0] == "/"):
                continue
            if self.skip_to is not None and not is_control(text):
                continue
            level = len(self.frames)
            if self._obey(here, text):
                return
            if self.next <= here and len(self.frames) == level:
                self.guard.jumped_back(self.next[0] + 1, level=level, executed=executed,
                                       flow=self._flow())  # fmt: skip
        self._finish()

    def _check_count(self, executed: int, line: int) -> None:
        """Give up where too many lines have been obeyed, `line` (1-based) the last of them."""
        self.controller.line = line - max(executed - self.max_blocks - 1, 0)
        check_count(executed, self.max_blocks)

    def _flow(self) -> tuple:
        """What decides which line follows, beside the controller's state."""
        return (self.frames, self.labels, self.skip_to, self.seeking_sub, self.defining,
                self.if_done, self.leaving, self.continuing)  # fmt: skip

    def _finish(self) -> None:
        if self.skip_to is not None:
            raise ProgramError(f"end of file while seeking O<{self.skip_to.split('#')[-1]}>",
                               line=self.skip_from[0] + 1, hint="the O-word has no partner")
        if self.frames:
            raise ProgramError(f"end of file inside subroutine O<{self.frames[-1].name}>")
        cutter_compensation.flush(self.controller)

    def _skip_percent(self) -> bool:
        """Step over a first line that is only %; tells whether there is one."""
        match = _OPENING.match(self.data, self.next[1])
        if match is None:
            return False
        self.next = (match.group().count(b"\n"), match.end())
        return True

    def _text(self, place: Place) -> tuple[str, int]:
        """Compact text of a line, and where the next one begins."""
        end = self.data.find(b"\n", place[1]) + 1 or len(self.data)
        self.controller.line = place[0] + 1
        result = compact(self.data[place[1] : end].decode("latin-1").rstrip("\r\n")), end
        if self.keep:
            self.texts[place[0]] = result
        return result

    def _obey(self, here: Place, text: str) -> bool:
        cache = self.blocks[bool(self.frames)]
        block = cache.get(here[0])
        if block is None:
            block = read_block(text, in_subroutine=bool(self.frames))
            if self.keep:
                cache[here[0]] = block
        if block.control is None:
            return self.skip_to is None and execute(self.controller, block)
        self._control(here, block, block.control)
        return False

    def _name(self, control: OWord) -> str:
        if control.keyword == "m99":
            return self.frames[-1].name
        if isinstance(control.name, str):
            name = control.name
        else:
            name = str(whole(value_of(control.name, self.controller.parameters), "O-word"))
        if control.keyword not in _LOCAL:
            return name
        owner = self.frames[-1].name if self.frames else self.defining or ""
        return f"{owner}#{name}"

    def _control(self, here: Place, block: Block, control: OWord) -> None:
        keyword = control.keyword
        if self.defining is not None:
            if keyword in ("sub", "program"):
                raise ProgramError("subroutine defined inside a subroutine")
            if keyword != "endsub":
                return
        name = self._name(control)
        if self.defining is not None and name != self.defining:
            return
        if self.skip_to is not None and name != self.skip_to:
            return
        if self.seeking_sub and keyword not in ("sub", "program"):
            return
        handler = getattr(self, f"_{keyword}", None) or self._end_loop
        handler(here, name, block)

    def _value(self, block: Block) -> float:
        return value_of(block.control.values[0], self.controller.parameters)

    def _skip(self, here: Place, name: str) -> None:
        self.skip_to, self.skip_from = name, here

    def _define(self, here: Place, name: str, keyword: str) -> None:
        known = self.labels.get(name)
        if known is not None and (known.keyword, known.place) != (keyword, here):
            label = name.split("#")[-1]
            raise ProgramError(f"O<{label}> is already used in line {known.place[0] + 1}",
                               hint="give each O-word its own number")
        if known is None:
            self.labels[name] = _Label(keyword, here)

    def _expect(self, name: str, *keywords: str) -> _Label:
        label = self.labels.get(name)
        if label is None or label.keyword not in keywords:
            wanted = " or ".join(keywords).upper()
            raise ProgramError(f"O<{name.split('#')[-1]}> has no {wanted}")
        return label

    # subroutines

    def _sub(self, here: Place, name: str, block: Block) -> None:
        if self.frames and self.frames[-1].keyword == "m98":
            raise ProgramError("O... sub called by M98", accepted="O... call")
        self._enter(here, name, "sub")
        if not self.frames:
            if name in self.labels:
                raise ProgramError(f"O<{name}> SUB stands where the program runs into it",
                                   hint="end the main program with M2 before it")
            self._define(here, name, "sub")
            self._skip(here, name)
            self.defining = name

    def _program(self, here: Place, name: str, block: Block) -> None:
        if self.frames and self.frames[-1].keyword == "call":
            raise ProgramError("Fanuc-style O number called by O-word", accepted="M98")
        self._enter(here, name, "program")

    def _enter(self, here: Place, name: str, keyword: str) -> None:
        if self.skip_to is not None:
            self._define(here, name, keyword)
            self.skip_to = None
        self.seeking_sub = False

    def _call(self, here: Place, name: str, block: Block) -> None:
        if self.skip_to is not None:
            return
        parameters = self.controller.parameters
        values = [value_of(v, parameters) for v in block.control.values]
        self._push(_Frame(name, "call", self.next, parameters.arguments()))
        parameters.set_arguments(values)
        self._jump_to_sub(here, name)

    def _m98(self, here: Place, name: str, block: Block) -> None:
        if self.skip_to is not None:
            return
        words = block.words
        repeats = 1
        if "l" in words:
            repeats = whole(value_of(words["l"], self.controller.parameters), "L word of M98")
        if repeats == 0:
            return
        self._push(_Frame(name, "m98", self.next, [], repeats))
        self._jump_to_sub(here, name)

    def _push(self, frame: _Frame) -> None:
        if len(self.frames) + 1 >= _LEVELS:
            raise ProgramError(f"subroutine calls nested deeper than {_LEVELS - 1}")
        self.frames.append(frame)
        self.controller.parameters.locals.append({})
        self.controller.saved_modes.append(None)

    def _jump_to_sub(self, here: Place, name: str) -> None:
        label = self.labels.get(name)
        if label is not None:
            self.next = label.place
        else:
            self._skip(here, name)
            self.seeking_sub = True

    def _endsub(self, here: Place, name: str, block: Block) -> None:
        if self.frames:
            self._return(here, name, block)
        elif self.defining is None:
            raise ProgramError("ENDSUB outside a subroutine")
        else:
            self.skip_to = self.defining = None

    def _return(self, here: Place, name: str, block: Block) -> None:
        if self.skip_to is not None and block.control.keyword == "return":
            return
        if not self.frames:
            raise ProgramError("RETURN outside a subroutine")
        if self.frames[-1].keyword == "m98":
            raise ProgramError("subprogram called by M98 must end with M99")
        parameters = self.controller.parameters
        values = block.control.values
        returned = self._value(block) if values else 0.0
        parameters.globals["_value"] = returned
        parameters.globals["_value_returned"] = float(bool(values))
        self.skip_to = None
        frame = self._pop()
        parameters.set_arguments(frame.arguments)

    def _m99(self, here: Place, name: str, block: Block) -> None:
        if self.skip_to is not None:
            return
        if self.frames[-1].keyword != "m98":
            raise ProgramError("M99 inside a subroutine called by O-word", accepted="O... endsub")
        frame = self.frames[-1]
        frame.repeats -= 1
        if frame.repeats > 0:
            self.controller.parameters.locals[-1] = {}
            self._jump_to_sub(here, frame.name)
        else:
            self._pop()

    def _pop(self) -> _Frame:
        controller, level = self.controller, len(self.controller.saved_modes)
        if level in controller.restore_on_return:
            controller.restore_on_return.discard(level)
            if controller.saved_modes[-1] is not None:
                controller.line = controller.record.line = self.frames[-1].return_to[0]
                restore_modes(controller)
        frame = self.frames.pop()
        controller.parameters.locals.pop()
        controller.saved_modes.pop()
        self.next = frame.return_to
        return frame

    # loops and branches

    def _do(self, here: Place, name: str, block: Block) -> None:
        self.skip_to = None
        self._define(here, name, "do")

    def _while(self, here: Place, name: str, block: Block) -> None:
        label = self.labels.get(name)
        if label is not None and label.keyword == "do":
            self.skip_to = None
            if self._value(block) != 0.0 and not self.leaving:
                self.next = label.place
            self.leaving = self.continuing = False
            return
        self._define(here, name, "while")
        self.skip_to = None
        if self._value(block) == 0.0:
            self._skip(here, name)

    def _repeat(self, here: Place, name: str, block: Block) -> None:
        self._define(here, name, "repeat")
        self.skip_to = None
        label = self.labels[name]
        if label.repeats is None:
            value = self._value(block)
            label.repeats = int(value + (0.5 if value >= 0.0 else -0.5))
        if label.repeats > 0:
            label.repeats -= 1
        else:
            label.repeats = None
            self._skip(here, name)

    def _if(self, here: Place, name: str, block: Block) -> None:
        self._define(here, name, "if")
        self.if_done = self._value(block) != 0.0
        if self.if_done:
            self.skip_to = None
        else:
            self._skip(here, name)

    def _elseif(self, here: Place, name: str, block: Block) -> None:
        self._expect(name, "if")
        if self.if_done:
            self._skip(here, name)
        elif self._value(block) != 0.0:
            self.skip_to, self.if_done = None, True

    def _else(self, here: Place, name: str, block: Block) -> None:
        self._expect(name, "if")
        if self.if_done:
            self._skip(here, name)
        else:
            self.skip_to, self.if_done = None, True

    def _endif(self, here: Place, name: str, block: Block) -> None:
        self._expect(name, "if")
        self.skip_to, self.if_done = None, True

    def _break(self, here: Place, name: str, block: Block) -> None:
        self._expect(name, "while", "do")
        self._skip(here, name)
        self.leaving = True

    def _continue(self, here: Place, name: str, block: Block) -> None:
        self._expect(name, "while", "do")
        if self.skip_to == name:
            return
        self._skip(here, name)
        self.continuing = True

    def _end_loop(self, here: Place, name: str, block: Block) -> None:
        label = self._expect(name, block.control.keyword.removeprefix("end"))
        if self.skip_to == name:
            self.skip_to = None
            if not self.continuing:
                return
            self.continuing = False
        self.next = label.place
