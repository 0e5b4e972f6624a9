"""LBL, CALL LBL and CALL PGM: subprograms, parts that are repeated, programs beside this one.

HEIDENHAIN TNC 640, User's Manual for Klartext Programming, "Subprograms and program section
repeats".
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.parameters import NUMBER
from gcode.errors import ProgramError
from gcode.language.called_programs import find_beside

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["KlartextFlow"]

_LABEL = re.compile(r"(?:CALL\s+)?LBL\s+(\d+|\"[^\"]*\")")
_LEVELS = 19


class KlartextFlow:
    """Labels of a program and what returns to them.

    Parameters
    ----------
    reader : KlartextReader
    """

    def __init__(self, reader: KlartextReader) -> None:
        self.reader = reader
        self.selected: str | None = None  #: program of SEL PGM
        self.labels: dict[str, int] = {}
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
        name = re.split(r"[\\/:]", content.removeprefix("CALL PGM").strip().strip('"'))[-1]
        ending = self.reader.ending.upper()
        found = find_beside(self.reader.options.folder, [name], endings=("", self.reader.ending))
        if found is None:
            raise ProgramError(
                f"program {name} is not beside this one",
                accepted=f"a file {name.upper().removesuffix(ending)}{ending} in its folder",
            )
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
        for index in range(len(self.reader.lines)):
            content = self.reader.content(index)
            if content.startswith("LBL") and self._name(content) == label:
                return index
        raise ProgramError(f"LBL {label} does not exist")

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
