"""Schema of what ``vmach batch --json`` prints."""

from __future__ import annotations

from vmach.schemas.base import Output

__all__ = ["Batch"]


class Batch(Output):
    """``batch --json``: what became of the cases of a study."""

    cases: int
    """Of the study, or of the shard."""
    there: int
    """Had results before."""
    done: int
    failed: int
    folder: str
    merged: str | None
    """Table of all results; null where none was asked for, or a case failed."""
