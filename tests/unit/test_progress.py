"""The progress bar: every stage moves until the next one begins."""

import io
import sys

import pytest
from rich.console import Console
from rich.progress import Progress

from vmach.base import bar, progress


@pytest.fixture
def bars(monkeypatch):
    """The bars that are drawn on a terminal."""
    console = Console(file=io.StringIO(), force_terminal=True)
    monkeypatch.setattr(progress, "is_terminal", lambda stream: True)
    monkeypatch.setattr(bar, "console", lambda stderr: console)
    made = []

    def keep(*columns, **options):
        made.append(Progress(*columns, **options))
        return made[-1]

    monkeypatch.setattr(bar, "Progress", keep)
    return made


def test_a_stage_of_unknown_length_moves_until_the_next_begins(bars):
    with progress.progress_bar() as report:
        report("read", 0, 1)
        (read,) = bars[0].tasks
        assert read.total is None  # rich lets such a bar run to and fro
        report("search", 0, 1)
        assert read.finished
        assert not bars[0].tasks[1].finished


def test_a_stage_of_known_length_shows_its_share(bars):
    with progress.progress_bar() as report:
        report("cut", 0, 1)
        report("measure", 1, 4)
        cut, measure = bars[0].tasks
        assert measure.percentage == 25.0
        report("cut", 1, 1)
        assert cut.finished and not measure.finished


def test_a_stage_of_known_length_says_how_long_it_still_takes(bars):
    clock = iter(range(1000))
    with progress.progress_bar() as report:
        bars[0].get_time = lambda: float(next(clock))
        report("read", 0, 1)
        for done in range(1, 6):
            report("cut", done, 10)
        read, cut = bars[0].tasks
        column = bars[0].columns[-1]
        cut.get_time = read.get_time = bars[0].get_time
        assert str(column.render(read)) == ""
        assert str(column.render(cut)).endswith(" to go")
        report("cut", 10, 10)
        assert str(column.render(cut)) == ""


def test_nothing_is_drawn_where_nobody_looks(monkeypatch):
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with progress.progress_bar() as report:
        assert report is progress.silent
