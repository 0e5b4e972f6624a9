"""A bar on the terminal, one line for each stage of the work."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from rich.progress import (
    BarColumn,
    Progress,
    Task,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from vmach.base.stage_clock import Progress as Report
from vmach.base.terminal import console

__all__ = ["drawn_bar"]

#: work that is over sooner shows nothing
_PATIENCE_S = 2.0


class _TimeToGo(TimeRemainingColumn):
    """What a stage of known length still takes; nothing where that cannot be told."""

    def render(self, task: Task) -> Text:
        if task.finished or task.total is None or task.time_remaining is None:
            return Text("")
        return Text.assemble(super().render(task), " to go")


@contextmanager
def drawn_bar() -> Iterator[Report]:
    """Give a function to report progress to, which standard error shows.

    The bar of a stage that begins with 0 of 1 runs to and fro until it is done or the next begins.
    """
    columns = TextColumn("{task.description:>9}"), BarColumn(), TimeElapsedColumn(), _TimeToGo()
    bar = Progress(*columns, console=console(stderr=True), transient=True)
    tasks: dict[str, TaskID] = {}

    def report(stage: str, done: int, total: int) -> None:
        if stage not in tasks:
            for task in bar.tasks:
                if task.total is None:
                    bar.update(task.id, completed=1, total=1)
            tasks[stage] = bar.add_task(stage, total=None)
        bar.update(tasks[stage], completed=done, total=total if done or total > 1 else None)

    # a clock of its own: a long first stage reports nothing for a while
    patience = threading.Timer(_PATIENCE_S, bar.start)
    patience.start()
    try:
        yield report
    finally:
        patience.cancel()
        patience.join()
        bar.stop()
