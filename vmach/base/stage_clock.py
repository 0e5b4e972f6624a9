"""Stages of a run: how long each took, and who is told how far it is."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

__all__ = ["Progress", "StageClock", "silent"]

#: called with the stage's name, the steps done and their number
Progress = Callable[[str, int, int], None]


def silent(stage: str, done: int, total: int) -> None:
    """Progress that nobody looks at."""


@dataclass
class StageClock:
    """Times stages and passes their progress on.

    Attributes
    ----------
    progress : Progress
    seconds : dict of str to float
        Duration of every finished stage, in the order in which they began.
    """

    progress: Progress = silent
    seconds: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str) -> Iterator[Callable[[int, int], None]]:
        """Time a block; gives a function to report its steps with (done, total)."""
        start = time.perf_counter()
        self.progress(name, 0, 1)
        yield lambda done, total: self.progress(name, done, total)
        self.progress(name, 1, 1)
        self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start
