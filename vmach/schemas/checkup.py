"""What ``vmach check --json`` prints."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from vmach.schemas.base import Output

__all__ = ["CheckOutput"]


class _Finding(Output):
    """One thing that a job lacks, has wrong, leaves doubtful or does not say."""

    weight: Literal["mend", "look", "assumed"]
    """No command goes on; results may be wrong; nobody has said it."""
    what: str
    """For people, with the value and its unit."""
    file: str
    """Empty where it is about no file."""
    line: int | None = Field(ge=1)
    """1-based line in `file`."""
    accepted: str
    hint: str


class _Collision(Output):
    """A move that brings a part of the tool where it must not be."""

    kind: Literal["rapid in material", "shank", "holder"]
    line: int
    tool: int
    time_s: float
    """When the move begins."""
    depth_mm: float
    """Height of the material inside the body where it is greatest."""
    place_mm: tuple[float, float, float]
    """The lowest point of that material, workpiece coordinates."""


class CheckOutput(Output):
    """What a job lacks."""

    ready: bool
    """Nothing has to be mended before the job can be run."""
    findings: list[_Finding]
    collisions: list[_Collision] | None = None
    """In the order of the program; null where they were not looked for, or there is no blank."""
