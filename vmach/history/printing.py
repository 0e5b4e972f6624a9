"""The history of a job as a table: a row a job."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from rich.table import Table

from vmach.history.history import Step

__all__ = ["history_table"]

#: longer names are folded in a narrow terminal; shorter ones stand in one piece
_UNBROKEN_NAME = 40


def history_table(steps: Sequence[Step], *, is_checked: bool) -> Table:
    """A row a job; in a narrow terminal all wraps before the name, which is typed next.

    Parameters
    ----------
    steps : sequence of Step
    is_checked : bool
        Whether the error on another part is known.
    """
    names = _names([step.job for step in steps])
    table = Table(title="RMS of measured minus predicted, um", title_justify="left")
    table.add_column("job", overflow="fold", no_wrap=max(map(len, names)) <= _UNBROKEN_NAME)
    table.add_column("added", overflow="fold")
    for heading in ("fitted", "held out", *(["other part"] if is_checked else [])):
        table.add_column(heading, justify="right")
    for name, s in zip(names, steps, strict=True):
        other = [] if s.check_rms_um is None else [f"{s.check_rms_um:.2f}"]
        table.add_row(name, ", ".join(s.added), f"{s.rms_um:.2f}", f"{s.held_out_um:.2f}", *other)
    return table


def _names(jobs: Sequence[Path]) -> list[str]:
    """Names of job files; with their folders where two of them are called alike."""
    names = [job.name for job in jobs]
    if len(set(names)) == len(names):
        return names
    return [os.path.relpath(job) for job in jobs]
