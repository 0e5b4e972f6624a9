"""CSV: one row a value."""

from __future__ import annotations

from vmach.report.figures.features import features_csv
from vmach.report.result import RunRecord

__all__ = ["content"]


def content(run: RunRecord, **more: object) -> bytes:
    """The table as UTF-8 text."""
    return features_csv(run.features).encode()
