"""Schema of what ``vmach batch --json`` prints."""

from __future__ import annotations

from vmach.schemas.base import Output

__all__ = ["Batch"]


class _Performance(Output):
    """A value of the drawing over all draws of one combination of the other values."""

    case: dict[str, str | float | int | bool]
    """The values of the cases but for ``draw``."""
    feature: str
    callout: str
    """As written, with ``smallest`` or ``largest`` behind it where a size has two values."""
    lower_mm: float | None
    """Null for geometrical tolerances."""
    upper_mm: float
    draws: int
    """That have a value."""
    not_cut: int
    """Draws in which no tool made the feature."""
    quantiles_mm: tuple[float, float, float]
    """At 0.135 %, 50 % and 99.865 %."""
    Pp: float | None
    """ISO 22514-2; null with fewer than 1000 draws, without scatter, or with one limit."""
    Ppk: float | None
    """The same of the nearer limit; null with fewer than 1000 draws or without scatter."""


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
    performance: list[_Performance]
    """Of studies with ``draw`` and ``drawing`` whose cases are all there; else empty."""
