"""What ``vmach import --json`` prints."""

from __future__ import annotations

from typing import Any, Literal

from vmach.schemas.base import Output

__all__ = ["ImportOutput"]


class _Section(Output):
    """Keys of one table of a machine or a job file."""

    file: Literal["machine", "job"]
    table: str
    """``errors.EXX``; empty for keys above the first table."""
    is_array: bool
    """One more ``[[table]]`` instead of the one ``[table]``."""
    values: dict[str, Any]
    """Files as in `files`: relative to the folder of results."""


class _Imported(Output):
    told: list[str]
    """What was taken for what, and the self-check of a table, in sentences."""
    files: list[str]
    """Tables, readings and points, relative to the folder of results."""
    sections: list[_Section]


class ImportOutput(Output):
    """What came of the files."""

    imported: list[_Imported]
    written: list[str]
    """Every file that was written; the lines of a file that is not here are in `sections`."""
    self_checks: list[str]
    """What instruments of the job would read on its machine, beside what they read.

    Also measuring points that the machine file lacks.
    """
