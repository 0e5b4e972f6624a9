"""What the schemas of all outputs share: strict records, notes, places and statistics."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field

from vmach.base.note import Kind, Level

__all__ = ["DrawnFigures", "Interval", "NoteRecord", "Output", "Vector"]

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


class _FirstOrder(Output):
    """Number of quantities at which first order was compared with the draws (JCGM 101, 8.1)."""

    confirmed: int
    refuted: int
    too_few_draws: int


class DrawnFigures(Output):
    """How a Monte Carlo calculation went (JCGM 101)."""

    method: Literal["monte-carlo"]
    coverage: float
    """Probability of the intervals, without unit."""
    digits: int
    """Significant digits of u that are to stand."""
    seed: int
    draws: int
    """Largest number of draws that a quantity took."""
    stand: int
    """Quantities whose figures stand (7.9.4)."""
    do_not_stand: int
    first_order: _FirstOrder
    contributors_percent: dict[str, float]
    """Share of the variance of first order, the largest first."""
