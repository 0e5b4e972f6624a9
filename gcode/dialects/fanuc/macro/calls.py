"""Programs and parts that a Fanuc program calls: M97, M98, M99, G65, G66, G67."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from gcode.dialects.fanuc.block import MacroBlock
from gcode.dialects.fanuc.increments import count_arguments
from gcode.dialects.fanuc.macro.line_text import PROGRAM, bare
from gcode.errors import ProgramError
from gcode.language.called_programs import Routine, find_beside, unknown_calls
from gcode.state.block_values import whole

if TYPE_CHECKING:
    from gcode.dialects.fanuc.reader import FanucReader

__all__ = ["Calls"]

#: Letter of an argument, specification I -> local variable (B-64484EN, "Custom macro").
_ARGUMENTS = {"a": 1, "b": 2, "c": 3, "i": 4, "j": 5, "k": 6, "d": 7, "e": 8, "f": 9, "h": 11,
              "m": 13, "q": 17, "r": 18, "s": 19, "t": 20, "u": 21, "v": 22, "w": 23, "x": 24,
              "y": 25, "z": 26}  # fmt: skip
_SETS = 10  #: of I J K in specification II
_LEVELS = 15  #: nesting of calls; more is a program that calls itself
#: of files that hold a program of their own
_ENDINGS = ("", ".nc", ".cnc", ".txt", ".tap", ".min", ".eia", ".ngc", ".prg")
#: a call by a number that is written out, in a line without blanks
_CALLED = re.compile(r"(m98|g6[56])(?![\d.])[^p]*p(\d+)(?![\d.])")


@dataclass
class _Call:
    return_to: int
    program: int  #: first line of the program or local part that runs
    repeats: int
    saved: dict[int, float] | None  #: locals of the caller; None for M98, which shares them
    begun: int = field(compare=False)  #: blocks obeyed when the present repetition began
    modal: bool = False  #: called by G66 behind a move


class Calls:
    """What a program has called, and where it goes on.

    Parameters
    ----------
    reader : FanucReader
    """

    def __init__(self, reader: FanucReader) -> None:
        self.reader = reader
        self.own = len(reader.lines)  #: lines behind these are of files beside the program
        self.appended: list[tuple[int, int, Routine]] = []
        self.stack: list[_Call] = []
        self.modal_call: list[tuple[str, float]] | None = None

    def obey(self, block: MacroBlock) -> None:
        """A block with one of the codes."""
        called = next((code for code in block.m if code in (97, 98, 99)), None)
        if called is not None:
            block.m.remove(called)
            arguments = block.pop("plq")
            self.reader.blocks.obey(block)
            {97: self._local_part, 98: self._subprogram, 99: self._return}[called](arguments)
        elif block.has(67):
            self.modal_call = None
            block.g.remove(67.0)
            self.reader.blocks.obey(block)
        else:
            if len(block.g) > 1 or block.m:
                raise ProgramError(
                    f"another {'G' if len(block.g) > 1 else 'M'} code beside a macro call",
                    accepted="G65 and its arguments alone",
                )
            words = count_arguments(self.reader.blocks, block)
            if block.has(66):
                self.modal_call = words
            else:
                self.call_macro(words)

    def _find(self, number: float) -> int:
        wanted = whole(number, "program number")
        program = self._sought(wanted)
        if program is None:
            raise self._unknown_calls(wanted)
        return program

    def _sought(self, wanted: int) -> int | None:
        """First line of a program, None where there is none."""
        found = self.reader.places.program(wanted)
        return self._append(wanted) if found is None else found

    def _unknown_calls(self, first: int) -> ProgramError:
        """One error for all programs that these lines call by number without having."""
        wanted = [first]
        for index in range(self.own):
            content = self.reader.content(index)
            if content.startswith("/") and self.reader.options.skips(1):
                continue
            for called in _CALLED.finditer(content):
                number = int(called[2])
                if called[1] == "m98" and number >= 10_000 and "l" not in content:
                    number %= 10_000  # repeats in front of the number
                if number not in wanted and not self._leaves_out(number):
                    wanted += [] if self._sought(number) is not None else [number]
        return unknown_calls([f"O{n}" for n in wanted], [f"O{n:04d}.nc" for n in wanted])

    def _leaves_out(self, number: float) -> bool:
        control = self.reader.options.control
        return control.ignores(f"O{number:.0f}") or control.ignores(f"O{number:04.0f}")

    def _ignores(self, number: float) -> bool:
        """Whether the job leaves out the calls of a program, which is noted."""
        ignored = self._leaves_out(number)
        if ignored:
            self.reader.controller.note(f"O{number:.0f}", "call left out by ignore_calls")
        return ignored

    def by_name(self, name: str, repeats: int) -> None:
        """M98 <NAME>: the program O<NAME> of this file."""
        self.reader.blocks.finish_corner()
        found = self.reader.places.program(name)
        if found is None:
            raise ProgramError(f"program O<{name.upper()}> is not in this file")
        self._enter(found, repeats)

    def _append(self, wanted: int) -> int | None:
        """Put a program from a file beside this one behind its lines; gives its first line."""
        names = [f"O{wanted:05d}", f"O{wanted:04d}", f"O{wanted}", f"{wanted:04d}", f"{wanted}"]
        found = find_beside(self.reader.options.folders, names, endings=_ENDINGS)
        if found is None:
            return None
        first = len(self.reader.lines)
        lines = [line for line in found.lines if line.strip() != "%"]
        head = [] if any(PROGRAM.match(bare(line)) for line in lines) else [f"O{wanted}"]
        self.appended.append((first, len(head), found))
        self.reader.lines = [*self.reader.lines, *head, *lines]
        self.reader.texts += [None] * (len(self.reader.lines) - first)
        self.reader.stop = len(self.reader.lines)
        return first

    @property
    def source_line(self) -> int:
        """Line of the program that called what runs from files beside it."""
        return next((c.return_to for c in self.stack if c.return_to <= self.own), self.own)

    def of_file(self, index: int) -> tuple[Path, int] | None:
        """File and 1-based line of a line that was appended."""
        for first, head, routine in reversed(self.appended):
            if index >= first:
                text, shift = routine.lines, index - first - head
                kept = [k for k, line in enumerate(text) if line.strip() != "%"]
                return routine.file, kept[max(shift, 0)] + 1
        return None

    def _enter(self, program: int, repeats: int) -> None:
        """Run a part with the same local variables."""
        if repeats > 0:
            executed = self.reader.budget.executed
            self._push(_Call(self.reader.next, program, repeats, None, executed))

    def _push(self, call: _Call) -> None:
        if len(self.stack) >= _LEVELS:
            raise ProgramError(f"calls nested deeper than {_LEVELS}")
        self.stack.append(call)
        self.reader.next = call.program

    def is_in_modal_call(self) -> bool:
        """Whether what runs was called by G66."""
        return any(call.modal for call in self.stack)

    def call_macro(self, words: list[tuple[str, float]], *, modal: bool = False) -> None:
        given = dict(words)
        if "p" not in given:
            raise ProgramError("macro call without P word", accepted="G65 P with the program")
        repeats = whole(given.get("l", 1.0), "L word")
        if repeats < 1 or self._ignores(given["p"]):
            return
        program = self._find(given["p"])
        arguments = _arguments([(k, v) for k, v in words if k not in "pl"])
        self._push(_Call(self.reader.next, program, repeats, self.reader.variables.locals,
                         self.reader.budget.executed, modal))  # fmt: skip
        self.reader.variables.locals = arguments

    def _subprogram(self, words: dict[str, float]) -> None:
        """M98 P100 L3, P30100 (three times O100), or Q for a block number."""
        repeats = whole(words.get("l", 1.0), "L word")
        if "p" not in words and "q" not in words:
            raise ProgramError("M98 without P word")
        if "p" not in words:
            program = self.reader.flow.labelled(whole(words["q"], "Q word"), "M98 Q")
        elif self._ignores(words["p"]):
            return
        else:
            number = whole(words["p"], "P word")
            sought = self._sought(number)
            if sought is None and number >= 10_000 and "l" not in words:
                repeats, number = number // 10_000, number % 10_000
            program = self._find(number) if sought is None else sought
        self._enter(program, repeats)

    def _local_part(self, words: dict[str, float]) -> None:
        """M97 P100: the part of this program that begins at N100 (Haas)."""
        if "p" not in words:
            raise ProgramError("M97 without P word", accepted="M97 P with a block number")
        repeats = whole(words.get("l", 1.0), "L word")
        program = self.reader.flow.labelled(whole(words["p"], "P word"), "M97 P")
        self._enter(program, repeats)

    def _return(self, words: dict[str, float]) -> None:
        if not self.stack:
            if "p" in words:
                self.reader.flow.jump(
                    self.reader.flow.labelled(whole(words["p"], "P word"), "M99 P")
                )
                return
            self.reader.controller.note("M99", "the control begins anew; the program is read once")
            self.reader.ended = True
            return
        call = self.stack[-1]
        call.repeats -= 1
        if call.repeats > 0:
            blocks, call.begun = (
                self.reader.budget.executed - call.begun,
                self.reader.budget.executed,
            )
            self.reader.budget.check_rounds(call.repeats, blocks, exact=False, line=call.return_to)
            self.reader.next = call.program
            return
        self.stack.pop()
        self.reader.next = call.return_to
        if call.saved is not None:
            self.reader.variables.locals = call.saved
        if "p" in words:
            self.reader.next = self.reader.flow.labelled(whole(words["p"], "P word"), "M99 P")


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
