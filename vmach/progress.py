"""A progress bar on the terminal for work that takes a while."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from vmach.stage_clock import Progress as Report
from vmach.stage_clock import silent

__all__ = ["progress_bar"]

#: work that is over sooner shows nothing
_PATIENCE_S = 2.0


@contextmanager
def progress_bar() -> Iterator[Report]:
    """Give a function to report progress to; it draws on standard error if that is a terminal."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield silent
        return
    columns = TextColumn("{task.description:>9}"), BarColumn(), TimeElapsedColumn()
    bar = Progress(*columns, console=console, transient=True)
    tasks: dict[str, int] = {}
    start = time.monotonic()

    def report(stage: str, done: int, total: int) -> None:
        if stage not in tasks:
            tasks[stage] = bar.add_task(stage, total=total)
        bar.update(tasks[stage], completed=done, total=total)
        if not bar.live.is_started and time.monotonic() - start > _PATIENCE_S:
            bar.start()

    try:
        yield report
    finally:
        bar.stop()
