"""Custom macro B: from block to block, with GOTO, WHILE, subprograms and macro calls."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path

from gcode.control.loop_guard import LoopGuard
from gcode.dialects.fanuc.block import MacroBlock, read_words
from gcode.dialects.fanuc.blocks import BlockRunner, FanucSettings
from gcode.dialects.fanuc.expressions import MacroReader, is_null
from gcode.dialects.fanuc.variables import MacroVariables
from gcode.errors import ProgramError
from gcode.language.called_programs import Routine, find_beside
from gcode.language.options import RunOptions
from gcode.language.translate import Translated
from gcode.state.block_values import whole
from gcode.state.controller import Controller
from gcode.text.expressions import value_of
from gcode.text.lexer import Block
from gcode.text.source import Source

__all__ = ["FanucReader"]

#: Letter of an argument, specification I -> local variable (B-64484EN, "Custom macro").
_ARGUMENTS = {"a": 1, "b": 2, "c": 3, "i": 4, "j": 5, "k": 6, "d": 7, "e": 8, "f": 9, "h": 11,
              "m": 13, "q": 17, "r": 18, "s": 19, "t": 20, "u": 21, "v": 22, "w": 23, "x": 24,
              "y": 25, "z": 26}  # fmt: skip
_SETS = 10  #: of I J K in specification II
_LEVELS = 15  #: nesting of calls; more is a program that calls itself
_HEAD = re.compile(r"(?:/[1-9]?)?(?:n(\d+))?(?:/[1-9]?)?")
_SLASH = re.compile(r"\s*(?:n\s*\d+\s*)?/\s*([1-9]?)(?!\s*\d)", re.IGNORECASE)
_LEADER = re.compile(r"^%(?=[o:]\d)")  #: of a tape; the program's number may follow
_UNIT = re.compile(r"G\s*2[01](?![\d.])", re.IGNORECASE)
_OUTPUT = ("dprnt", "bprnt", "popen", "pclos", "setvn")
_CALL_BY_NAME = re.compile(r"m98<([^>]*)>(?:l(\d+))?")
_PROGRAM = re.compile(r"(?:o|:)(?:(\d+)|<([^>]*)>)")
_COMMENT = re.compile(r"\((?:[^()]|\([^()]*\))*\)?")
_BLANKS = str.maketrans("", "", " \t\r\x0b\x0c")
#: of files that hold a program of their own
_ENDINGS = ("", ".nc", ".cnc", ".txt", ".tap", ".min", ".eia", ".ngc", ".prg")
_NO_WORDS = frozenset(("", "%", ";"))


def _bare(line: str) -> str:
    return _COMMENT.sub("", line).translate(_BLANKS).lower()


@dataclass
class _Call:
    return_to: int
    program: int  #: first line of the program or local part that runs
    repeats: int
    saved: dict[int, float] | None  #: locals of the caller; None for M98, which shares them
    begun: int = field(compare=False)  #: blocks obeyed when the present repetition began
    modal: bool = False  #: called by G66 behind a move


class FanucReader(Translated):
    """Runs a Fanuc program; one file may hold several, the first is the main program."""

    settings = FanucSettings()

    def __init__(self, controller: Controller, lines: list[str], options: RunOptions) -> None:
        super().__init__(controller, lines, options)
        self.texts: list[str | None] = [None] * len(lines)
        self.own = len(lines)  #: lines behind these are of files beside the program
        self.appended: list[tuple[int, int, Routine]] = []
        self.calls: list[_Call] = []
        self.guard = LoopGuard(controller)
        self.variables = MacroVariables(controller, self.settings.columns,
                                        radius_in_d=self.settings.radius_in_d,
                                        counters=self.settings.counters)  # fmt: skip
        self.blocks = BlockRunner(self, self.settings)
        self.modal_call: list[tuple[str, float]] | None = None
        self.fast = self.starts = None
        self._forms = (
            ("IF", re.compile(r"if(\[.*\])go(?:to)?(.+)"), self._if_goto),
            ("IF THEN", re.compile(r"if(\[.*\])th(?:en)?(.+)"), self._if_then),
            ("GOTO", re.compile(r"go(?:to)?([\d#\[].*)"), self._goto),
            ("WHILE", re.compile(r"wh(?:ile)?(\[.*\])do(\d+)"), self._while),
            ("DO", re.compile(r"do(\d+)"), lambda _: None),
            ("END", re.compile(r"en(?:d)?(\d+)"), self._end),
        )

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
        if self.fast is None or self.modal_call is not None:
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
        if self.next > self.own:
            if self.next == self.own + 1 and not self.calls:  # the end of the program's own text
                self.ended = True
                return
            self._obey_elsewhere(text)
        else:
            self._obey(text)

    def _obey_elsewhere(self, text: str) -> None:
        place = self._of_file(self.next - 1)
        try:
            self._obey(text)
        except ProgramError as error:
            raise error.located(file=place[0], line=place[1]) from None

    def _obey(self, text: str) -> None:
        if self._is_deleted(text):
            return
        content = self._content(self.next - 1)
        if content[:1] in ("i", "g", "w", "d", "e"):
            for name, pattern, action in self._forms:
                match = pattern.fullmatch(content)
                if match:
                    self.controller.use(name)
                    self.blocks.finish_corner()
                    action(*match.groups())
                    return
        self._statement(content)

    def _is_deleted(self, text: str) -> bool:
        """Whether the switch of an optional block skip takes the block away."""
        found = _SLASH.match(text) if "/" in text else None
        return found is not None and self.options.skips(int(found[1] or 1))

    def _content(self, index: int) -> str:
        """Text of a line without block number, blanks, comments and end-of-block sign."""
        text = self.texts[index]
        if text is None:
            text = self.lines[index]
            text = _COMMENT.sub("", text) if "(" in text else text
            text = text.split(";")[0].translate(_BLANKS).lower()
            text = self.texts[index] = _LEADER.sub("", text[_HEAD.match(text).end() :])
        return text

    def _statement(self, content: str) -> None:
        if content in _NO_WORDS:
            return
        if content.startswith("%"):
            raise ProgramError(f"cannot read '{content}'", accepted="%, or % with O and a number",
                               hint="FAGOR, NUM and early SINUMERIK begin so")  # fmt: skip
        if content.startswith(_OUTPUT):
            self.controller.note(content[:5].upper(), "output to a device")
            return
        if _PROGRAM.match(content):
            if self.next > 1 and not self.calls:
                self._check_end(content)
            content = content[_PROGRAM.match(content).end() :]
            if not content:
                return
        if content.startswith("#"):
            self._assign(content)
            return
        by_name = _CALL_BY_NAME.fullmatch(content)
        if by_name:
            self._call_by_name(by_name[1], int(by_name[2] or 1))
            return
        block = read_words(content, self.variables)
        self._use(block)
        if block.has(65, 66, 67) or any(code in (97, 98, 99) for code in block.m):
            self.blocks.finish_corner()
            self._call_block(block)
        else:
            self._note_step(block)
            moved = self.blocks.obey(block)
            self.ended = self.blocks.ended
            if moved and self.modal_call is not None and not self._in_modal_call():
                self._macro_call(self.modal_call, modal=True)

    def says_unit(self) -> bool:
        """Whether G20 or G21 stands anywhere in the text."""
        bare = (_COMMENT.sub("", line) if "(" in line else line for line in self.lines)
        return any(_UNIT.search(line) for line in bare)

    def m_codes(self) -> set[int]:
        """M codes with plain numbers anywhere in the text."""
        found = (re.findall(r"m(\d+)", self._content(k)) for k in range(len(self.lines)))
        return {int(code) for codes in found for code in codes}

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
        first = next((i for i in range(len(self.lines)) if _PROGRAM.match(self._content(i))), 0)
        if self.next - 1 > first:
            raise ProgramError(
                f"program {content.upper()} begins before the main program ends",
                hint="end the main program with M30",
            )

    def value(self, text: str) -> float:
        """Value of an expression; NaN for <null>."""
        reader = MacroReader(f"[{text}]")
        value = value_of(reader.bracket(), self.variables)
        if reader.position != len(reader.text):
            raise ProgramError(f"cannot read '{reader.text[reader.position :]}' in an expression")
        return value

    def _number(self, text: str, what: str) -> int:
        value = self.value(text)
        return whole(0.0 if is_null(value) else value, what)

    def _assign(self, content: str) -> None:
        left, equals, right = content[1:].partition("=")
        if not equals:
            raise ProgramError(f"cannot read '{content}'", accepted="#1=...")
        self.variables.set(self._number(left, "variable number"), self.value(right))

    # branches

    def _if_goto(self, condition: str, target: str) -> None:
        if self._is_true(condition):
            self._goto(target)

    def _if_then(self, condition: str, statement: str) -> None:
        if self._is_true(condition):
            self._statement(statement)

    def _is_true(self, condition: str) -> bool:
        value = self.value(condition)
        return not is_null(value) and value != 0.0

    def _goto(self, target: str) -> None:
        wanted = self._number(target, "GOTO")
        self._jump(self._labelled(wanted, "GOTO"))

    def _labelled(self, wanted: int, what: str) -> int:
        """Line of a block number: forwards from here to the end, then from the beginning."""
        start, stop = self._program_lines()
        for index in (*range(self.next, stop), *range(start, self.next)):
            text = self.lines[index].translate(_BLANKS).lower()
            match = _HEAD.match(text)
            if match[1] is not None and int(match[1]) == wanted:
                return index
        raise ProgramError(f"{what}{wanted}: no block N{wanted} in this program")

    def _jump(self, index: int) -> None:
        """Go on at another line of the running program."""
        if index < self.next:
            self.guard.jumped_back(
                index + 1, level=len(self.calls), executed=self.budget.executed,
                flow=(self.calls, self.variables.locals, self.variables.common,
                      self.blocks.memory()),
            )  # fmt: skip
        self.next = index

    def _program_lines(self) -> tuple[int, int]:
        """First line of the running program, and the line at which the next begins."""
        start = self.calls[-1].program if self.calls else 0
        while start > 0 and not _PROGRAM.match(self._content(start)):  # within a local part
            start -= 1
        begun = False
        for index in range(start, len(self.lines)):
            if _PROGRAM.match(self._content(index)):
                if begun:
                    return start, index
                begun = True
        return start, len(self.lines)

    def _while(self, condition: str, label: str) -> None:
        if self._is_true(condition):
            return
        stop = self._program_lines()[1]
        for index in range(self.next, stop):
            if re.fullmatch(rf"en(?:d)?{label}", self._content(index)):
                self.next = index + 1
                return
        raise ProgramError(f"DO{label} without END{label}")

    def _end(self, label: str) -> None:
        start = self._program_lines()[0]
        for index in range(self.next - 2, start - 1, -1):
            if re.fullmatch(rf"(?:wh(?:ile)?\[.*\])?do{label}", self._content(index)):
                self._jump(index)
                return
        raise ProgramError(f"END{label} without DO{label}")

    # calls

    def _call_block(self, block: MacroBlock) -> None:
        called = next((code for code in block.m if code in (97, 98, 99)), None)
        if called is not None:
            block.m.remove(called)
            arguments = block.pop("plq")
            self.blocks.obey(block)
            {97: self._local_part, 98: self._subprogram, 99: self._return}[called](arguments)
        elif block.has(67):
            self.modal_call = None
            block.g.remove(67.0)
            self.blocks.obey(block)
        else:
            if len(block.g) > 1:
                raise ProgramError(
                    "another G code beside a macro call", accepted="G65 and its arguments alone"
                )
            words = list(block.all_words)
            if block.has(66):
                self.modal_call = words
            else:
                self._macro_call(words)

    def _find(self, number: float) -> int:
        wanted = whole(number, "program number")
        for index in range(len(self.lines)):
            match = _PROGRAM.match(self._content(index))
            if match and match[1] is not None and int(match[1]) == wanted:
                return index
        beside = self._append(wanted)
        if beside is not None:
            return beside
        raise ProgramError(
            f"program O{wanted} is neither in this file nor beside it",
            accepted=f"a file O{wanted:04d}.nc in the folder of the program",
            hint="put the called program into the same file",
        )

    def _call_by_name(self, name: str, repeats: int) -> None:
        """M98 <NAME>: the program O<NAME> of this file."""
        self.blocks.finish_corner()
        for index in range(len(self.lines)):
            match = _PROGRAM.match(self._content(index))
            if match and match[2] == name:
                if repeats > 0:
                    self._push(_Call(self.next, index, repeats, None, self.budget.executed))
                return
        raise ProgramError(f"program O<{name.upper()}> is not in this file")

    def _append(self, wanted: int) -> int | None:
        """Put a program from a file beside this one behind its lines; gives its first line."""
        names = [f"O{wanted:05d}", f"O{wanted:04d}", f"O{wanted}", f"{wanted:04d}", f"{wanted}"]
        found = find_beside(self.options.folder, names, endings=_ENDINGS)
        if found is None:
            return None
        first = len(self.lines)
        lines = [line for line in found.lines if line.strip() != "%"]
        head = [] if any(_PROGRAM.match(_bare(line)) for line in lines) else [f"O{wanted}"]
        self.appended.append((first, len(head), found))
        self.lines = [*self.lines, *head, *lines]
        self.texts += [None] * (len(self.lines) - first)
        self.stop = len(self.lines)
        return first

    def source_line(self, index: int) -> int:
        """Line of the program; what a file beside it does is done by the line that calls it."""
        if index < self.own:
            return index + 1
        return next((c.return_to for c in self.calls if c.return_to <= self.own), self.own)

    def _of_file(self, index: int) -> tuple[Path, int] | None:
        """File and 1-based line of a line that was appended."""
        for first, head, routine in reversed(self.appended):
            if index >= first:
                text, shift = routine.lines, index - first - head
                kept = [k for k, line in enumerate(text) if line.strip() != "%"]
                return routine.file, kept[max(shift, 0)] + 1
        return None

    def _push(self, call: _Call) -> None:
        if len(self.calls) >= _LEVELS:
            raise ProgramError(f"calls nested deeper than {_LEVELS}")
        self.calls.append(call)
        self.next = call.program

    def _in_modal_call(self) -> bool:
        return any(call.modal for call in self.calls)

    def _macro_call(self, words: list[tuple[str, float]], *, modal: bool = False) -> None:
        given = dict(words)
        if "p" not in given:
            raise ProgramError("macro call without P word", accepted="G65 P with the program")
        repeats = whole(given.get("l", 1.0), "L word")
        if repeats < 1:
            return
        program = self._find(given["p"])
        arguments = _arguments([(k, v) for k, v in words if k not in "pl"])
        self._push(_Call(self.next, program, repeats, self.variables.locals,
                         self.budget.executed, modal))  # fmt: skip
        self.variables.locals = arguments

    def _subprogram(self, words: dict[str, float]) -> None:
        """M98 P100 L3, P30100 (three times O100), or Q for a block number."""
        repeats = whole(words.get("l", 1.0), "L word")
        if "p" not in words and "q" not in words:
            raise ProgramError("M98 without P word")
        if "p" not in words:
            program = self._labelled(whole(words["q"], "Q word"), "M98 Q")
        else:
            number = whole(words["p"], "P word")
            try:
                program = self._find(number)
            except ProgramError:
                if number < 10_000 or "l" in words:
                    raise
                repeats, program = number // 10_000, self._find(number % 10_000)
        if repeats > 0:
            self._push(_Call(self.next, program, repeats, None, self.budget.executed))

    def _local_part(self, words: dict[str, float]) -> None:
        """M97 P100: the part of this program that begins at N100 (Haas)."""
        if "p" not in words:
            raise ProgramError("M97 without P word", accepted="M97 P with a block number")
        repeats = whole(words.get("l", 1.0), "L word")
        program = self._labelled(whole(words["p"], "P word"), "M97 P")
        if repeats > 0:
            self._push(_Call(self.next, program, repeats, None, self.budget.executed))

    def _return(self, words: dict[str, float]) -> None:
        if not self.calls:
            if "p" in words:
                self._jump(self._labelled(whole(words["p"], "P word"), "M99 P"))
                return
            self.controller.note("M99", "the control begins anew; the program is read once")
            self.ended = True
            return
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
            self.variables.locals = call.saved
        if "p" in words:
            self.next = self._labelled(whole(words["p"], "P word"), "M99 P")


def _arguments(words: list[tuple[str, float]]) -> dict[int, float]:
    """Local variables of a macro call; I J K that stand again are those of specification II."""
    values: dict[int, float] = {}
    seen = dict.fromkeys("ijk", 0)
    for letter, value in words:
        if letter not in _ARGUMENTS:
            raise ProgramError(
                f"argument {letter.upper()} of a macro call", accepted="A to Z without G L N O P"
            )
        number = _ARGUMENTS[letter]
        if letter in seen:
            if seen[letter] >= _SETS:
                raise ProgramError(f"more than {_SETS} words {letter.upper()} in a macro call")
            number += 3 * seen[letter]
            seen[letter] += 1
        if not math.isnan(value):
            values[number] = value
    return values
