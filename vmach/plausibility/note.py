"""A note: what in a user's files is wrong, doubtful or assumed, as a record."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

__all__ = ["Kind", "Level", "Note"]


class Level(StrEnum):
    """How certain it is that something is wrong, the worst first."""

    REFUSED = "refused"  #: it cannot be so; no command goes on
    CONTRADICTION = "contradiction"  #: two statements exclude each other
    DOUBT = "doubt"  #: unlikely: look at the report of the measurement again
    NOTE = "note"  #: what was assumed


class Kind(StrEnum):
    """What a note is about."""

    SIZE = "size"  #: the values of a table
    POSITION = "position"  #: where a table lies along its axis
    PLACE = "place"  #: the measuring point
    SLOPE = "slope"
    COPY = "copy"
    SQUARENESS = "squareness"
    PROVENANCE = "provenance"
    MISSING = "missing"
    ROWS = "rows"
    CURVE = "curve"
    DIAMETER = "diameter"
    LENGTH = "length"


@dataclass(frozen=True)
class Note:
    """Something in a file that cannot be so, is unlikely, or that a reader should know.

    Attributes
    ----------
    level : Level
    kind : Kind
    subject : str
        Components, squareness or tools, separated by blanks.
    sentence : str
        What is noted, for people; nothing is decided by its words.
    size : float or None
        The worst number that it is about, in `unit`.
    unit : str
    accepted : str
    hint : str
        What to do about it.
    """

    level: Level
    kind: Kind
    subject: str
    sentence: str
    size: float | None = None
    unit: str = ""
    accepted: str = ""
    hint: str = ""

    @property
    def text(self) -> str:
        """Subject, sentence, what is accepted and the hint."""
        told = f"{self.subject}: {self.sentence}"
        told += f"; accepted: {self.accepted}" if self.accepted else ""
        return told + (f" (hint: {self.hint})" if self.hint else "")

    def __str__(self) -> str:
        return f"{self.level}: {self.text}"
