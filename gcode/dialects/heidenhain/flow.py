"""LBL, CALL LBL and CALL PGM: subprograms, parts that are repeated, programs beside this one.

HEIDENHAIN TNC 640, User's Manual for Klartext Programming, "Subprograms and program section
repeats".
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.parameters import NUMBER
from gcode.errors import ProgramError
from gcode.language.called_programs import Routine, find_beside, unknown_calls

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["KlartextFlow", "measuring_cycle"]

_LABEL = re.compile(r"(?:CALL\s+)?LBL\s+(\d+|\"[^\"]*\")")
_LEVELS = 19
_MEASURING = re.compile(r"TCH PROBE\s*(\d+)")


def measuring_cycle(content: str) -> str | None:
    """``TCH PROBE 411`` of a block that measures, None for any other."""
    found = _MEASURING.match(content)
    return f"TCH PROBE {found[1]}" if found else None


def _program_of(content: str) -> str:
    """Name of the program that CALL PGM calls, without folders."""
    return re.split(r"[\\/:]", content.removeprefix("CALL PGM").strip().strip('"'))[-1].upper()


class KlartextFlow:
    """Labels of a program and what returns to them.

    Parameters
    ----------
    reader : KlartextReader
    """

    def __init__(self, reader: KlartextReader) -> None:
        self.reader = reader
        self.selected: str | None = None  #: program of SEL PGM
        self.labels: dict[str, int] = {}  #: that were passed
        self._places: dict[str, int] = {}  #: of labels among the lines that were searched
        self._searched = 0
        self.begun: dict[str, int] = {}  #: blocks obeyed when what stands below a label began
        #: label line, return line, repeats left, what `begun` was before the repeats
        self.calls: list[tuple[int, int, int, int]] = []

    def select_program(self, content: str) -> None:
        """SEL PGM: the program that CALL SELECTED PGM will call."""
        self.selected = content.removeprefix("SEL PGM").strip()

    def call_program(self, content: str) -> None:
        """CALL PGM: a program in a file beside this one, with the same Q parameters."""
        if content.startswith("CALL SELECTED PGM"):
            if self.selected is None:
                raise ProgramError("CALL SELECTED PGM without SEL PGM before it")
            content = self.selected
        name = _program_of(content)
        if self.reader.options.control.ignores(name):
            self.reader.noted(f"CALL PGM {name}", "call left out by ignore_calls")
            return
        found = self._found(name)
        if found is None:
            raise self.unknown_calls(name)
        if self.reader.depth >= _LEVELS:
            raise ProgramError(f"programs nested deeper than {_LEVELS}")
        reader = self.reader
        called = type(reader)(reader.controller, list(found.lines), reader.options)
        for shared in ("parameters", "budget", "motion", "cycles", "frames"):
            setattr(called, shared, getattr(reader, shared))
        reader.motion.belong_to(called)
        called.called_at, called.depth = reader.controller.line, reader.depth + 1
        reader.cycles.reader = reader.frames.reader = called
        try:
            called.run()
        except ProgramError as error:
            raise error.located(file=found.file, line=called.own_line(called.next - 1)) from None
        reader.cycles.reader = reader.frames.reader = reader
        reader.motion.belong_to(reader)
        reader.ended = called.stopped

    def _found(self, name: str) -> Routine | None:
        endings = ("", self.reader.ending)
        return find_beside(self.reader.options.folders, [name], endings=endings)

    def unknown_calls(self, first: str) -> ProgramError:
        """One error for all programs and measuring cycles that these lines call without having."""
        reader, names, files = self.reader, [first], []
        for index in range(len(reader.lines)):
            content = reader.content(index)
            if content.startswith("/") and reader.options.skips(1):
                continue
            content = content.removeprefix("/").strip()
            name = measuring_cycle(content) or ""
            if content.startswith("CALL PGM"):
                name = _program_of(content)
                if self._found(name) is not None:
                    continue
                ending = reader.ending.upper()
                files.append(f"{name.removesuffix(ending)}{ending}")
            if name and not reader.options.control.ignores(name):
                names.append(name)
        return unknown_calls(names, files)

    def _name(self, content: str) -> str:
        match = _LABEL.match(content)
        if match is None:
            raise ProgramError(f"cannot read '{content}'", accepted="a label with a number or name")
        return match[1]

    def label(self, content: str) -> None:
        label = self._name(content)
        if label != "0":
            self.labels[label], self.begun[label] = (
                self.reader.next - 1,
                self.reader.budget.executed,
            )
        elif self.calls and self.calls[-1][2] < 0:
            self.reader.next = self.calls.pop()[1]

    def find(self, label: str) -> int:
        """Index of the line of a label."""
        while label not in self._places and self._searched < len(self.reader.lines):
            content = self.reader.content(self._searched)
            if content.startswith("LBL"):
                self._places.setdefault(self._name(content), self._searched)
            self._searched += 1
        if label not in self._places:
            raise ProgramError(f"LBL {label} does not exist")
        return self._places[label]

    def call_label(self, content: str) -> None:
        """CALL LBL n jumps to a subprogram that LBL 0 ends; with REP it repeats what is above."""
        label = self._name(content)
        repeats = re.search(rf"REP\s*({NUMBER})?", content)
        if repeats and repeats[1]:
            self._repeat(label, int(self.reader.parameters.number(repeats[1])))
            return
        target = self.find(label)
        if len(self.calls) >= _LEVELS:
            raise ProgramError(f"subprograms nested deeper than {_LEVELS}")
        self.calls.append((target, self.reader.next, -1, 0))
        self.reader.next = target + 1

    def _repeat(self, label: str, repeats: int) -> None:
        here = self.reader.next
        if label not in self.labels:
            raise ProgramError(f"LBL {label} is not above this block")
        if self.calls and self.calls[-1][:2] == (self.labels[label], here):
            *_, left, begun = self.calls.pop()
        else:
            left, begun = repeats, self.begun[label]
            self.reader.budget.check_rounds(repeats, self.reader.budget.executed - begun)
        if left > 0:
            self.calls.append((self.labels[label], here, left - 1, begun))
            self.reader.next, self.begun[label] = (
                self.labels[label] + 1,
                self.reader.budget.executed,
            )
        else:
            self.begun[label] = begun
