"""Subprograms, and parts of a program that are repeated.

Source: SINUMERIK 840D sl/828D, Programming Manual Job Planning, "Subprogram technique", "Program
section repetition".
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from gcode.dialects.sinumerik.text_places import PROCEDURE, SECTION, TextPlaces
from gcode.errors import ProgramError
from gcode.language.called_programs import Routine, find_beside

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["Subprograms"]

_LEVELS = 16  #: program levels of the control
_NO_FILE = Path("places")  #: of lines that stand for a block of the program
_PARAMETER = re.compile(
    r"(VAR\s+)?(REAL|INT|BOOL|CHAR|AXIS|STRING\s*\[\d+\])\s+(\w+)\s*(?:=\s*(.*))?", re.IGNORECASE
)
#: what a VAR parameter may be given: it is changed where the subprogram changes it
_TARGET = re.compile(r"R\d+|\$?[A-Z_][A-Z_]\w*(?:\[[^\]]*\])?|R\[.*\]", re.IGNORECASE)


@dataclass
class _Level:
    """What goes on when a subprogram, or a repeated part, has ended."""

    routine: Routine
    next: int
    stop: int
    left: int  #: further rounds
    start: int  #: of a round
    named: dict[str, float] | None  #: variables of the caller; None for a repeated part
    line: int | None  #: of the program's file that calls
    given_back: tuple[tuple[str, str], ...] = ()  #: VAR: the caller's variable and the parameter
    is_modal: bool = False  #: called by MCALL behind a move


class Subprograms:
    """Levels of a running program.

    Parameters
    ----------
    reader : SinumerikReader
    """

    def __init__(self, reader: SinumerikReader) -> None:
        self.reader, self.levels = reader, []
        self._texts: dict[int, TextPlaces] = {}
        self._beside: dict[str, Routine | None] = {}  #: files that calls have looked for
        lines = reader.lines
        self.routine = Routine(lines, 0, self._end_of_section(lines, 0))
        reader.stop = self.routine.stop

    @staticmethod
    def _end_of_section(lines: Sequence[str], start: int) -> int:
        """Where the section of an archive ends in which a line stands."""
        heads = [k for k in range(start, len(lines)) if SECTION.match(lines[k])]
        return heads[1] if len(heads) > 1 else len(lines)

    @property
    def file(self) -> Path | None:
        """File beside the program whose lines run; None within its own."""
        return None if self.routine.file is _NO_FILE else self.routine.file

    @property
    def source_line(self) -> int | None:
        """Line of the program's file that called a file beside it; None within its own."""
        return next((level.line for level in self.levels if level.line is not None), None)

    def memory(self) -> list[tuple]:
        """What tells one round of a loop from another."""
        return [(level.next, level.left, level.start) for level in self.levels]

    def is_in_modal_call(self) -> bool:
        """Whether what runs was called by MCALL, whose own moves call nothing."""
        return any(level.is_modal for level in self.levels)

    def run(self, lines: Sequence[str]) -> None:
        """Run lines that stand for this block, then go on behind it."""
        reader = self.reader
        line = reader.controller.line if self.routine.file is None else None
        level = _Level(self.routine, reader.next, reader.stop, 0, 0, None, line)
        self._push(level)
        self._enter(Routine(list(lines), 0, len(lines), _NO_FILE), 0, len(lines))

    def call(
        self, name: str, texts: Sequence[str], rounds: int = 1, *, is_modal: bool = False
    ) -> None:
        """Go to a subprogram.

        Parameters
        ----------
        name : str
        texts : sequence of str
            Arguments as they stand in the block; blanks for one that is left out.
        rounds : int
            P: how often it runs.
        is_modal : bool
            Called by MCALL behind a move.

        Raises
        ------
        ProgramError
            It is nowhere, has other parameters, or calls itself too often.
        """
        routine = self._find(name)
        if routine is None:
            raise self.reader.unknown(call=name.upper())
        if rounds < 1:
            return
        reader = self.reader
        named, given_back = self._parameters(routine, name, texts)
        is_elsewhere = routine.file is not None and self.routine.file is None
        line = reader.controller.line if is_elsewhere else None
        self._push(
            _Level(
                self.routine,
                reader.next,
                reader.stop,
                rounds - 1,
                routine.start,
                reader.variables.named,
                line,
                given_back,
                is_modal,
            )
        )
        self._enter(routine, routine.start, routine.stop)
        reader.variables.named = named

    def is_there(self, name: str) -> bool:
        """Whether a subprogram can be called."""
        return self._find(name) is not None

    def repeat(self, start: int, stop: int, rounds: int) -> None:
        """Run lines of the present program so many times, then go on behind this block."""
        reader = self.reader
        if rounds < 1:
            return
        self._push(_Level(self.routine, reader.next, reader.stop, rounds - 1, start, None, None))
        reader.next, reader.stop = start, stop

    def leave(self) -> bool:
        """End of a subprogram or a repeated part; False at the end of the program."""
        if not self.levels:
            return False
        reader, level = self.reader, self.levels[-1]
        if level.left > 0:
            level.left -= 1
            reader.next = level.start
            return True
        self.levels.pop()
        self._enter(level.routine, level.next, level.stop)
        if level.named is not None:
            inner, reader.variables.named = reader.variables.named, level.named
            for target, parameter in level.given_back:
                reader.variables.assign(target, inner[parameter])
        return True

    def returned(self) -> bool:
        """RET and M17: parts that are repeated end with their subprogram."""
        while self.levels and self.levels[-1].named is None:
            level = self.levels.pop()
            self.reader.stop = level.stop
        return self.leave()

    def _push(self, level: _Level) -> None:
        calls = sum(level.named is not None for level in self.levels)
        if max(calls, len(self.levels) // 2) >= _LEVELS:  # parts that are repeated nest as well
            raise ProgramError(f"subprograms nested deeper than {_LEVELS}")
        self.levels.append(level)

    def _enter(self, routine: Routine, start: int, stop: int) -> None:
        self.routine = routine
        self.reader.lines, self.reader.next, self.reader.stop = routine.lines, start, stop

    def _find(self, name: str) -> Routine | None:
        for lines, file in self._places():
            found = self.places_of(lines, file).program(name)
            if found is not None:
                return Routine(lines, *found, file)
        stem = name.upper()
        if stem not in self._beside:
            names = [f"{stem}.{end}" for end in ("SPF", "MPF")]
            names += [f"_N_{stem}_{end}" for end in ("SPF", "MPF")]
            self._beside[stem] = find_beside(self.reader.options.folders, names)
        return self._beside[stem]

    def places_of(self, lines: Sequence[str], file: Path | None) -> TextPlaces:
        """Programs and labels of a text; what stands for one block is not kept."""
        known = self._texts.get(id(lines))
        if known is None:
            known = TextPlaces(lines, self.reader.label_of)
            if file is not _NO_FILE:
                self._texts[id(lines)] = known
        return known

    def _places(self) -> list[tuple[Sequence[str], Path | None]]:
        """Texts that may hold the program: the present one, then those that called it."""
        routines = [self.routine, *(level.routine for level in reversed(self.levels))]
        return [(r.lines, r.file) for r in {id(r.lines): r for r in routines}.values()]

    def _parameters(
        self, routine: Routine, name: str, texts: Sequence[str]
    ) -> tuple[dict[str, float], tuple[tuple[str, str], ...]]:
        """Variables of the subprogram from the head ``PROC NAME(REAL A, VAR INT B)``.

        The second value says which of them go back into variables of the caller.
        """
        arguments = [self.reader.variables.value(t) if t.strip() else None for t in texts]
        heads = (PROCEDURE.match(routine.lines[k]) for k in range(routine.start, routine.stop))
        head = next((h for h in heads if h), None)
        said = head[2] if head is not None and head[2] else ""
        wanted = [piece.strip() for piece in said.split(",") if piece.strip()]
        if len(arguments) > len(wanted):
            raise ProgramError(
                f"{name} with {len(arguments)} arguments",
                accepted=f"{len(wanted)} as its PROC line says",
            )
        values: dict[str, float] = {}
        given_back = []
        for index, piece in enumerate(wanted):
            match = _PARAMETER.fullmatch(piece)
            if match is None:
                raise ProgramError(f"cannot read the parameter '{piece}' of {name}")
            given = arguments[index] if index < len(arguments) else None
            if given is None:
                given = self.reader.variables.value(match[4]) if match[4] else 0.0
            values[match[3].upper()] = given
            if match[1] and index < len(arguments) and _TARGET.fullmatch(texts[index].strip()):
                given_back.append((texts[index].strip().upper(), match[3].upper()))
        return values, tuple(given_back)
