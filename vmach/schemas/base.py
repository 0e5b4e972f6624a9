"""What the schemas of all outputs share: strict records, notes, places and statistics."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

from vmach.base.note import Kind, Level

__all__ = ["Interval", "NoteRecord", "Output", "Vector"]

Vector = tuple[float, float, float]
Interval = tuple[float, float]


class Output(BaseModel):
    """A record of an output file: exactly these keys, each with one unit."""

    model_config = ConfigDict(extra="forbid", use_attribute_docstrings=True)


class NoteRecord(Output):
    """A note as a record; see `vmach.base.note.Note`."""

    level: Level
    """How certain it is that something is wrong."""
    kind: Kind
    """What the note is about."""
    subject: str
    """Components, squareness or tools, separated by blanks."""
    sentence: str
    """For people; nothing is decided by its words."""
    size: float | None
    """The worst number, or the count, in `unit`."""
    unit: str
    """Of `size`; "1" for a count, empty where there is no size."""
    accepted: str
    hint: str
    place: str
    """Column, tool, feature or axis that the sentence names."""
    file: str
    """Name of the file that it is about; may be empty."""
    line: int | None = Field(ge=1)
    """1-based line in `file`."""
    text: str
    """All of it, as it is printed."""
