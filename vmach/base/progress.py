"""A progress bar on the terminal for work that takes a while."""

from __future__ import annotations

import json
import os
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

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
from vmach.base.stage_clock import silent
from vmach.base.terminal import console

__all__ = ["PROGRESS_LINES", "progress_bar"]

#: set in the environment of a command by a program that shows its progress: instead of a bar,
#: lines ``{"stage", "done", "total"}`` of JSON go to standard error, at most so many a second
PROGRESS_LINES = "VMACH_PROGRESS_LINES"
_LINES_PER_S = 10.0

#: work that is over sooner shows nothing
_PATIENCE_S = 2.0


class _TimeToGo(TimeRemainingColumn):
    """What a stage of known length still takes; nothing where that cannot be told."""

    def render(self, task: Task) -> Text:
        if task.finished or task.total is None or task.time_remaining is None:
            return Text("")
        return Text.assemble(super().render(task), " to go")


@contextmanager
def progress_bar() -> Iterator[Report]:
    """Give a function to report progress to; it draws on standard error if that is a terminal.

    The bar of a stage that begins with 0 of 1 runs to and fro until it is done or the next begins.
    """
    if os.environ.get(PROGRESS_LINES):
        yield _line_teller()
        return
    screen = console(stderr=True)
    if not screen.is_terminal:
        yield silent
        return
    columns = TextColumn("{task.description:>9}"), BarColumn(), TimeElapsedColumn(), _TimeToGo()
    bar = Progress(*columns, console=screen, transient=True)
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


def _line_teller() -> Report:
    """Progress for a program: a line where a stage begins, ends, or some time has passed."""
    last: dict[str, Any] = {"stage": "", "at": 0.0}

    def report(stage: str, done: int, total: int) -> None:
        now = time.monotonic()
        is_news = stage != last["stage"] or done >= total or now - last["at"] > 1 / _LINES_PER_S
        if is_news:
            last.update(stage=stage, at=now)
            print(json.dumps({"stage": stage, "done": done, "total": total}), file=sys.stderr,
                  flush=True)  # fmt: skip

    return report
