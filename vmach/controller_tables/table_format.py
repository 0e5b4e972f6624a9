"""What a format of compensation tables is: what it holds, how it is written and read back.

Source: ISO/TR 16907 for the kinds of compensation.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from vmach.controller_tables.knots import Knots
from vmach.controller_tables.projection import AxisTable, Projection, Term
from vmach.controller_tables.table_task import TableTask
from vmach.errors import InputError

__all__ = [
    "LARGEST",
    "UNLIMITED_ENTRIES",
    "AppliedTables",
    "HeldErrors",
    "TableFormat",
    "error_name",
    "projected",
]

#: largest error of a table that is believed, mm or rad; chosen: a thousand times what is usual
LARGEST = 10.0
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


@dataclass(frozen=True)
class HeldErrors:
    """The errors that a control's tables take back, as component errors.

    Attributes
    ----------
    tables : dict of ISO 230-1 symbol to (position_mm, forward, backward)
        Of the tool relative to the workpiece, actual minus nominal, in mm or rad.
    squareness_rad : dict of ``EC0Y`` and the like to float
    order : str
        Axes from the workpiece to the tool, all on the tool's side; empty where the tables hold
        for any chain, because they have no angles.
    told : tuple of str
        What the files hold that the control does not use.
    """

    tables: dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]
    squareness_rad: dict[str, float] = field(default_factory=dict)
    order: str = ""
    told: tuple[str, ...] = ()


def error_name(output_axis: int, input_axis: int) -> str:
    """Symbol of the error along one axis as another one moves: ``EYX``."""
    return f"E{'XYZ'[output_axis]}{'XYZ'[input_axis]}"


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
    errors : callable or None
        From a folder of such files to the errors that they take back; None where these are no
        component errors.
    sign : str
        Name of the file that tells such a folder.
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
    errors: Callable[[Path, Mapping[str, Any]], HeldErrors] | None = None
    sign: str = ""

    def __post_init__(self) -> None:
        wrong = {
            "name": not (isinstance(self.name, str) and _NAME.fullmatch(self.name)),
            "rank": not isinstance(self.rank, int),
            "most_entries": not (isinstance(self.most_entries, int) and self.most_entries >= 2),
            "write": not callable(self.write),
            "read": not callable(self.read),
            "terms": not (self.terms is None or callable(self.terms)),
            "errors": not (self.errors is None or (callable(self.errors) and self.sign)),
        }
        wrong |= {
            key: not (isinstance(text := getattr(self, key), str) and text.strip())
            for key in ("title", "holds", "lacks")
        }
        if key := next((key for key, is_wrong in wrong.items() if is_wrong), None):
            raise InputError(
                f"table format {self.name!r}: {key} = {getattr(self, key)!r}",
                accepted="name in lower case with hyphens; title, holds and lacks in words; "
                "whole numbers rank and most_entries; functions write, read, terms and errors, "
                "the last with sign = the name of a file",
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
