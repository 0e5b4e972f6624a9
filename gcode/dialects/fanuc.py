"""Fanuc with Macro B: G65, IF, WHILE, GOTO over the blocks of RS274/NGC.

Numbers are read as they stand (calculator-type decimal points). Variables that were never set
are <null> on the control, where a word with such a value does not exist; here they are refused.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from gcode.control.interpreter import execute
from gcode.control.loop_guard import LoopGuard
from gcode.errors import ProgramError
from gcode.language.dialect import Dialect
from gcode.language.options import RunOptions
from gcode.language.translate import Translated
from gcode.state.block_values import whole
from gcode.state.controller import Controller
from gcode.text.expressions import Reader, value_of
from gcode.text.lexer import Block, compact, read_block

__all__ = ["Fanuc"]

#: Letter of a G65 argument -> local variable.
_ARGUMENTS = {"a": 1, "b": 2, "c": 3, "i": 4, "j": 5, "k": 6, "d": 7, "e": 8, "f": 9, "h": 11,
              "m": 13, "q": 17, "r": 18, "s": 19, "t": 20, "u": 21, "v": 22, "w": 23, "x": 24,
              "y": 25, "z": 26}  # fmt: skip
_LOCALS = range(1, 34)
_LEVELS = 9  #: nesting of calls; more is a program that calls itself
_HEAD = re.compile(r"/?(?:n(\d+))?")
_PROGRAM = re.compile(r"(?:o|:)(\d+)")
_ARGUMENT = re.compile(r"[a-z]")


@dataclass
class _Call:
    return_to: int
    program: int
    repeats: int
    saved: dict[int, float] | None  #: locals of the caller; None for M98, which shares them
    begun: int = field(compare=False)  #: blocks obeyed when the present repetition began


class FanucReader(Translated):
    """Runs a Fanuc program; one file may hold several, the first is the main program."""

    def __init__(self, controller: Controller, lines: list[str], options: RunOptions) -> None:
        super().__init__(controller, lines, options)
        self.texts: list[str | None] = [None] * len(lines)
        self.calls: list[_Call] = []
        self.guard = LoopGuard(controller)
        self.radius_offset: float | None = None  #: D stays in force between blocks
        numbers = controller.parameters.numbered
        controller.parameters.computed.update(
            {i: _unset(controller, i) for i in (*_LOCALS, *range(100, 1000)) if i not in numbers}
        )

    def obey(self, text: str) -> None:
        """Obey one line."""
        content = self._content(self.next - 1)
        for pattern, action in (
            (r"if(\[.*\])goto(.+)", self._if_goto),
            (r"if(\[.*\])then(.+)", self._if_then),
            (r"goto(.+)", self._goto),
            (r"while(\[.*\])do(\d+)", self._while),
            (r"do(\d+)", lambda _: None),
            (r"end(\d+)", self._end),
        ):
            match = re.fullmatch(pattern, content)
            if match:
                action(*match.groups())
                return
        self._statement(content)

    def _content(self, index: int) -> str:
        """Compact text of a line without block number, comments and end-of-block sign."""
        text = self.texts[index]
        if text is None:
            text = re.sub(r"\([^)]*\)", "", compact(self.lines[index])).split(";")[0]
            text = self.texts[index] = text[_HEAD.match(text).end() :]
        return text

    def _statement(self, content: str) -> None:
        if not content or content == "%" or _PROGRAM.fullmatch(content):
            if _PROGRAM.fullmatch(content) and self.next > 1 and not self.calls:
                self._check_end(content)
            return
        if content.startswith("#"):
            self._assign(content)
        elif re.match(r"g0*65(?![\d.])", content):
            self._macro_call(content)
        elif re.match(r"m0*98(?!\d)", content):
            self._subprogram(content)
        elif re.fullmatch(r"m0*99", content):
            self._return()
        elif re.search(r"g0*66(?!\d)|g0*67(?!\d)", content):
            raise ProgramError("modal macro call G66 is not read", accepted="G65")
        else:
            self._block(content)

    def _check_end(self, content: str) -> None:
        """A second program begins: the main program has no end."""
        first = next((i for i in range(len(self.lines)) if _PROGRAM.match(self._content(i))), 0)
        if self.next - 1 > first:
            raise ProgramError(f"program {content.upper()} begins before the main program ends",
                               hint="end the main program with M30")

    def _value(self, text: str) -> float:
        reader = Reader(f"[{text}]")
        value = value_of(reader.bracket(), self.controller.parameters)
        if reader.position != len(reader.text):
            raise ProgramError(f"cannot read '{reader.text[reader.position:]}' in an expression")
        return value

    def _assign(self, content: str) -> None:
        left, equals, right = content[1:].partition("=")
        if not equals:
            raise ProgramError(f"cannot read '{content}'", accepted="#1=...")
        index = whole(self._value(left), "variable number")
        value = self._value(right)
        self.controller.parameters.computed.pop(index, None)
        self.controller.parameters.set(index, value)

    def _block(self, content: str) -> None:
        block = read_block(content)
        self._modal_offset(block)
        self.ended = execute(self.controller, block)

    def _modal_offset(self, block: Block) -> None:
        """Remember D where no G41 or G42 uses it, and add it where they stand without."""
        switches = any(code in (41.0, 42.0) for code in block.g_codes)
        if "d" in block.words and not switches:
            self.radius_offset = block.words.pop("d")
        elif switches and "d" not in block.words and self.radius_offset is not None:
            block.words["d"] = self.radius_offset

    # branches

    def _if_goto(self, condition: str, target: str) -> None:
        if self._value(condition):
            self._goto(target)

    def _if_then(self, condition: str, statement: str) -> None:
        if self._value(condition):
            self._statement(statement)

    def _goto(self, target: str) -> None:
        wanted = whole(self._value(target), "GOTO")
        start, stop = self._program_lines()
        for index in range(start, stop):
            match = _HEAD.match(compact(self.lines[index]))
            if match[1] is not None and int(match[1]) == wanted:
                self._jump(index)
                return
        raise ProgramError(f"GOTO{wanted}: no block N{wanted} in this program")

    def _jump(self, index: int) -> None:
        """Go on at another line of the running program."""
        if index < self.next:
            self.guard.jumped_back(index + 1, level=len(self.calls), executed=self.budget.executed,
                                   flow=(self.calls, self.radius_offset))  # fmt: skip
        self.next = index

    def _program_lines(self) -> tuple[int, int]:
        """First line of the running program, and the line at which the next begins."""
        start = self.calls[-1].program if self.calls else 0
        begun = False
        for index in range(start, len(self.lines)):
            if _PROGRAM.match(self._content(index)):
                if begun:
                    return start, index
                begun = True
        return start, len(self.lines)

    def _while(self, condition: str, label: str) -> None:
        if self._value(condition):
            return
        stop = self._program_lines()[1]
        for index in range(self.next, stop):
            if self._content(index) == f"end{label}":
                self.next = index + 1
                return
        raise ProgramError(f"DO{label} without END{label}")

    def _end(self, label: str) -> None:
        start = self._program_lines()[0]
        for index in range(self.next - 2, start - 1, -1):
            if re.fullmatch(rf"(?:while\[.*\])?do{label}", self._content(index)):
                self._jump(index)
                return
        raise ProgramError(f"END{label} without DO{label}")

    # calls

    def _find(self, number: float) -> int:
        wanted = whole(number, "program number")
        for index in range(len(self.lines)):
            match = _PROGRAM.match(self._content(index))
            if match and int(match[1]) == wanted:
                return index
        raise ProgramError(f"program O{wanted} is not in this file",
                           hint="put the called program into the same file")

    def _words(self, content: str, skip: int) -> dict[str, float]:
        """Values of the words after the first `skip` characters; G65 allows any letter."""
        reader, words = Reader(content), {}
        reader.position = skip
        while reader.position < len(content):
            letter = reader.peek()
            if not _ARGUMENT.match(letter):
                raise ProgramError(f"cannot read '{content[reader.position:]}'")
            reader.position += 1
            words[letter] = value_of(reader.value(), self.controller.parameters)
        return words

    def _push(self, call: _Call) -> None:
        if len(self.calls) >= _LEVELS:
            raise ProgramError(f"calls nested deeper than {_LEVELS}")
        self.calls.append(call)
        self.next = call.program

    def _macro_call(self, content: str) -> None:
        words = self._words(content, re.match(r"g0*65", content).end())
        if "p" not in words:
            raise ProgramError("G65 without P word")
        program, repeats = self._find(words.pop("p")), whole(words.pop("l", 1.0), "L word")
        unknown = words.keys() - _ARGUMENTS.keys()
        if unknown:
            raise ProgramError(f"G65 argument {min(unknown).upper()}",
                               accepted="A-F H-K M Q-Z without G L N O P")
        parameters = self.controller.parameters
        saved = {i: parameters.numbered[i] for i in _LOCALS if i not in parameters.computed}
        self._push(_Call(self.next, program, repeats, saved, self.budget.executed))
        self._set_locals({_ARGUMENTS[letter]: value for letter, value in words.items()})

    def _set_locals(self, values: dict[int, float]) -> None:
        parameters = self.controller.parameters
        for index in _LOCALS:
            parameters.computed[index] = _unset(self.controller, index)
        for index, value in values.items():
            del parameters.computed[index]
            parameters.numbered[index] = value

    def _subprogram(self, content: str) -> None:
        words = self._words(content, re.match(r"m0*98", content).end())
        if "p" not in words:
            raise ProgramError("M98 without P word")
        repeats = whole(words.get("l", 1.0), "L word")
        if repeats > 0:
            program = self._find(words["p"])
            self._push(_Call(self.next, program, repeats, None, self.budget.executed))

    def _return(self) -> None:
        if not self.calls:
            raise ProgramError("M99 in the main program repeats it for ever", hint="use M30")
        call = self.calls[-1]
        call.repeats -= 1
        if call.repeats > 0:
            blocks, call.begun = self.budget.executed - call.begun, self.budget.executed
            self.budget.check_rounds(call.repeats, blocks, exact=False, line=call.return_to)
            self.next = call.program
            return
        self.calls.pop()
        self.next = call.return_to
        if call.saved is not None:
            self._set_locals(call.saved)


def _unset(controller: Controller, index: int):
    def read() -> float:
        raise ProgramError(f"variable #{index} is <null>: never set",
                           hint="set it, or call the program by G65 with its argument")

    return read


class Fanuc(Dialect):
    """FANUC with custom macro B."""

    name = "fanuc"
    title = "FANUC Series 0i and 30i"
    source = "FANUC Series 30i/31i/32i-B Operator's Manual B-64484EN, part II"
    rank = 20
    marks = re.compile(
        r"^[ \t]*(?:N\d+[ \t]*)?(?:IF[ \t]*\[[^\n]*\][ \t]*(?:GOTO|THEN)"
        r"|WHILE[ \t]*\[[^\n]*\][ \t]*DO|GOTO[ \t]*[\d#\[]|END[ \t]*[123]\b)"
        r"|^[^(;\n]*\bG0*6[56](?![\d.])",
        re.IGNORECASE | re.MULTILINE,
    )
    reader = FanucReader
    is_rs274 = True
    reads = ("linuxcnc", "haas")
