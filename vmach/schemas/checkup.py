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


class CheckOutput(Output):
    """What a job lacks."""

    ready: bool
    """Nothing has to be mended before the job can be run."""
    findings: list[_Finding]
