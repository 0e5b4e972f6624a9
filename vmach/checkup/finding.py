"""One thing that a job lacks, has wrong, leaves doubtful or lets the program assume."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from gcode import ProgramError
from vmach.base.note import Level, Note
from vmach.errors import InputError

__all__ = ["Finding", "Weight"]


class Weight(StrEnum):
    """What a finding asks for."""

    MEND = "mend"  #: no command goes on
    LOOK = "look"  #: results may be wrong
    ASSUMED = "assumed"  #: nobody has said it


@dataclass(frozen=True)
class Finding:
    """One finding.

    Attributes
    ----------
    weight : Weight
    what : str
        With the value and its unit.
    file : Path or None
    line : int or None
        1-based.
    accepted, hint : str
    """

    weight: Weight
    what: str
    file: Path | None = None
    line: int | None = None
    accepted: str = ""
    hint: str = ""

    @classmethod
    def of_error(cls, error: InputError | ProgramError) -> Finding:
        """A refusal."""
        file = None if error.file is None else Path(error.file)
        what = getattr(error, "what", None) or str(error)
        return cls(Weight.MEND, what, file, error.line, error.accepted or "", error.hint or "")

    @classmethod
    def of_note(cls, note: Note) -> Finding:
        """A note; what was merely assumed asks for nothing."""
        weight = Weight.ASSUMED if note.level is Level.NOTE else Weight.LOOK
        file = Path(note.file) if note.file else None
        said = f"{note.subject}: {note.sentence}" if note.subject else note.sentence
        return cls(weight, said, file, note.line, note.accepted, note.hint)

    def __str__(self) -> str:
        """One line for people."""
        where = "" if self.file is None else str(self.file)
        where += f":{self.line}" if self.file is not None and self.line else ""
        text = f"{where}: {self.what}" if where else self.what
        text += f"; accepted: {self.accepted}" if self.accepted else ""
        return text + (f" (hint: {self.hint})" if self.hint else "")
