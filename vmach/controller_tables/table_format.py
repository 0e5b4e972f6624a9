"""What a format of compensation tables is: what it holds, how it is written and read back.

Source: ISO/TR 16907 for the kinds of compensation.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from vmach.controller_tables.knots import Knots
from vmach.controller_tables.projection import AxisTable, Projection, Term
from vmach.controller_tables.table_task import TableTask
from vmach.errors import InputError

__all__ = ["UNLIMITED_ENTRIES", "AppliedTables", "TableFormat", "projected"]

#: tables whose largest entry is below this share of the tolerance are left out
_NEGLIGIBLE = 0.1
#: of one table, where the control sets no limit
UNLIMITED_ENTRIES = 251
_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


class AppliedTables(Protocol):
    """Tables as a control has read them."""

    def applied_correction(
        self, nose_mm: np.ndarray, direction: np.ndarray, tool_mm: np.ndarray
    ) -> np.ndarray:
        """What the control adds to the commanded positions, (P, 3) mm."""


Write = Callable[[Path, TableTask, tuple[Knots, Knots, Knots], Mapping[str, Any]], list[Path]]


@dataclass(frozen=True)
class TableFormat:
    """One format of compensation tables.

    Attributes
    ----------
    name : str
        What the command line and the folders call it.
    rank : int
        Its place in lists, the smallest first.
    title : str
    holds, lacks : str
        What it can and cannot correct.
    most_entries : int
        Of one table.
    write, read : callable
        Files from a task, and tables from files; the keyword options go to both.
    terms : callable or None
        Terms that the format can hold, for a task; None where it holds the error model itself.
    """

    name: str
    rank: int
    title: str
    holds: str
    lacks: str
    most_entries: int
    write: Write
    read: Callable[[Path, Mapping[str, Any]], AppliedTables]
    terms: Callable[[TableTask], list[Term]] | None = None

    def __post_init__(self) -> None:
        wrong = {
            "name": not (isinstance(self.name, str) and _NAME.fullmatch(self.name)),
            "rank": not isinstance(self.rank, int),
            "most_entries": not (isinstance(self.most_entries, int) and self.most_entries >= 2),
            "write": not callable(self.write),
            "read": not callable(self.read),
            "terms": not (self.terms is None or callable(self.terms)),
        }
        wrong |= {
            key: not (isinstance(text := getattr(self, key), str) and text.strip())
            for key in ("title", "holds", "lacks")
        }
        if key := next((key for key, is_wrong in wrong.items() if is_wrong), None):
            raise InputError(
                f"table format {self.name!r}: {key} = {getattr(self, key)!r}",
                accepted="name in lower case with hyphens; title, holds and lacks in words; "
                "whole numbers rank and most_entries; functions write, read and terms",
            )


def projected(
    task: TableTask, terms: list[Term], knots: tuple[Knots, Knots, Knots]
) -> tuple[Projection, list[AxisTable]]:
    """Fit of the terms that matter, and their tables."""
    samples = task.fit_samples(knots)
    projection = Projection(terms, knots, samples)
    tables = projection.tables(samples.error_mm)
    kept = [t for t in tables if t.largest_mm > _NEGLIGIBLE * task.tolerance_mm]
    if len(kept) == len(tables):
        return projection, tables
    projection = Projection([table.term for table in kept], knots, samples)
    return projection, projection.tables(samples.error_mm)
