"""A progress bar on the terminal for work that takes a while."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from vmach.base.stage_clock import Progress as Report
from vmach.base.stage_clock import silent
from vmach.base.terminal import is_terminal

__all__ = ["PROGRESS_LINES", "progress_bar"]

#: set in the environment of a command by a program that shows its progress: instead of a bar,
#: lines ``{"stage", "done", "total"}`` of JSON go to standard error, at most so many a second
PROGRESS_LINES = "VMACH_PROGRESS_LINES"
_LINES_PER_S = 10.0


@contextmanager
def progress_bar() -> Iterator[Report]:
    """Give a function to report progress to; it draws on standard error if that is a terminal."""
    if os.environ.get(PROGRESS_LINES):
        yield _line_teller()
        return
    if not is_terminal(sys.stderr):
        yield silent
        return
    from vmach.base.bar import drawn_bar  # late: where nobody looks, rich is not loaded

    with drawn_bar() as report:
        yield report


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
