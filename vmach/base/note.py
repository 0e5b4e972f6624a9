"""A note: what in a user's files is wrong, doubtful, assumed or worth knowing, as a record.

Whoever decides something by a note asks for its level, kind, size or place. The sentence is for
people alone.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from enum import StrEnum
from pathlib import Path
from typing import Any

__all__ = ["Kind", "Level", "Note", "in_file", "note_records"]


class Level(StrEnum):
    """How certain it is that something is wrong, the worst first."""

    REFUSED = "refused"  #: it cannot be so; no command goes on
    CONTRADICTION = "contradiction"  #: two statements exclude each other
    DOUBT = "doubt"  #: unlikely: look at the report of the measurement again
    QUESTION = "question"  #: unusual: the sentence asks what may be mistaken
    NOTE = "note"  #: what was assumed, left out or found


#: levels that `str` puts before a note
_NAMED_LEVELS = (Level.REFUSED, Level.CONTRADICTION, Level.DOUBT)


class Kind(StrEnum):
    """What a note is about."""

    # the machine's tables
    SIZE = "size"  #: the values of a table
    POSITION = "position"  #: where a table lies along its axis
    PLACE = "place"  #: the measuring point
    SLOPE = "slope"
    COPY = "copy"
    SQUARENESS = "squareness"
    PROVENANCE = "provenance"
    MISSING = "missing"
    ROWS = "rows"  #: rows sorted, gaps filled
    CURVE = "curve"
    DIRECTION = "direction"  #: tables of the two directions of motion
    # tools and the program
    DIAMETER = "diameter"
    LENGTH = "length"
    TOOL = "tool"  #: which tool is in the spindle
    TOOL_OFFSET = "tool offset"
    CONTROL = "control"  #: which one the program was read for
    TILT = "tilt"  #: of the tool, which three axes cannot correct
    COLLISION = "collision"
    TRAVEL = "travel"
    # the nominal part, and the virtual one
    FACETS = "facets"  #: a mesh in place of surfaces
    GAP = "gap"  #: edges or corners that miss each other
    INSIDE_OUT = "inside out"
    BODIES = "bodies"  #: solids and surfaces of a CAD file
    NARROW = "narrow"  #: faces without room for a point
    UNCUT = "uncut"
    GOUGED = "gouged"
    OVERCUT = "overcut"
    ALIGNMENT = "alignment"
    SOLID = "solid"  #: the virtual part was not cut as a solid
    DIFFERENCE = "difference"  #: of the virtual part and the nominal CAD
    # measurements
    UNIT = "unit"  #: numbers that look like those of another unit
    COLUMN = "column"  #: a column that is not used
    NAME = "name"  #: a name that occurs twice
    REPEAT = "repeat"  #: points, rows or readings that occur again
    FAR = "far"  #: measured points far from the nominal ones
    ROUNDING = "rounding"
    UNCERTAINTY = "uncertainty"
    LEFT_OUT = "left out"  #: readings that do not count
    SIGN = "sign"  #: of the last motion, or of the way round
    STILL = "still"  #: a column that never changes
    CLOCK = "clock"
    LOST_MOTION = "lost motion"
    EXCHANGED = "exchanged"  #: what readings look like if one thing in the files is mistaken
    SCATTER = "scatter"  #: of what an explanation leaves, beside the stated uncertainty
    CANCELLING = "cancelling"  #: effects and forms that cancel in part
    IMPOSSIBLE = "impossible"  #: a fitted size that nature does not have
    NOT_CALLED_FOR = "not called for"  #: an effect that the measurements do not ask for
    KEPT = "kept"  #: an effect of the job that was not fitted anew
    ONCE = "once"  #: an effect that began at one moment of one part
    # evaluations
    RUNS = "runs"  #: too few runs for a figure, or their numbers
    OUTLIER = "outlier"  #: a reading far from those of the other runs
    TARGETS = "targets"
    BUDGET = "budget"  #: of uncertainty


@dataclass(frozen=True)
class Note:
    """Something that cannot be so, is unlikely, or that a reader should know.

    Attributes
    ----------
    level : Level
    kind : Kind
    subject : str
        Components, squareness or tools, separated by blanks; said before the sentence. Empty
        where the sentence names what it is about.
    sentence : str
        What is noted, for people; nothing is decided by its words.
    size : float or None
        The worst number, or the count, that it is about, in `unit`.
    unit : str
        Of `size`; "1" for a count.
    accepted : str
    hint : str
        What to do about it.
    place : str
        Column, tool, feature or axis that the sentence names.
    file : str
        Name of the file that it is about.
    line : int or None
        1-based line in `file`.
    """

    level: Level
    kind: Kind
    subject: str
    sentence: str
    size: float | None = None
    unit: str = ""
    accepted: str = ""
    hint: str = ""
    place: str = ""
    file: str = ""
    line: int | None = None

    @classmethod
    def plain(
        cls, kind: Kind, sentence: str, size: float | None = None, unit: str = "", **rest: Any
    ) -> Note:
        """What was assumed, left out or found; `rest` are other attributes."""
        return cls(Level.NOTE, kind, "", sentence, size, unit, **rest)

    @classmethod
    def question(
        cls, kind: Kind, sentence: str, size: float | None = None, unit: str = "", **rest: Any
    ) -> Note:
        """What is unusual, in a sentence that asks; `rest` are other attributes."""
        return cls(Level.QUESTION, kind, "", sentence, size, unit, **rest)

    @property
    def text(self) -> str:
        """Subject, sentence, what is accepted and the hint."""
        told = f"{self.subject}: {self.sentence}" if self.subject else self.sentence
        told += f"; accepted: {self.accepted}" if self.accepted else ""
        return told + (f" (hint: {self.hint})" if self.hint else "")

    @property
    def labelled(self) -> str:
        """The text with the level before it, whichever it is."""
        return f"{self.level}: {self.text}"

    def __str__(self) -> str:
        where = f"{self.file}:{self.line}: " if self.line is not None else f"{self.file}: "
        text = self.labelled if self.level in _NAMED_LEVELS else self.text
        return where + text if self.file else text

    def record(self) -> dict[str, Any]:
        """As it stands in JSON: the attributes, and the whole as people read it in `text`."""
        # counts of numpy are no numbers of JSON
        size = getattr(self.size, "item", lambda: self.size)()
        return asdict(self) | {"size": size, "text": str(self)}


def in_file(notes: Iterable[Note], file: Path, line: int | None = None) -> tuple[Note, ...]:
    """Notes, each with the file that it is about."""
    return tuple(replace(note, file=file.name, line=line or note.line) for note in notes)


def note_records(notes: Iterable[Note]) -> list[dict[str, Any]]:
    """Notes as they stand in JSON."""
    return [note.record() for note in notes]
