"""The table of ``vmach history`` in a terminal of 80 columns: what is typed next stands whole."""

from __future__ import annotations

import io
from pathlib import Path

import pytest
from rich.console import Console

from vmach.history import Step
from vmach.history.printing import history_table


def printed(name):
    """Lines of the table with another part to check on, and a long list of effects."""
    added = ("scale X", "scale Y", "thermal_growth Z")
    steps = [Step(Path("job.toml"), (), 1.99, 2.5, 1.99), Step(Path(name), added, 0.8, 0.9, 0.8)]
    file = io.StringIO()
    Console(file=file, width=80).print(history_table(steps, is_checked=True))
    return file.getvalue().splitlines()


@pytest.mark.parametrize("name", ["lost-motion.toml", "lost-motion-of-the-second-axis.toml"])
def test_names_stand_in_one_piece(name):
    lines = printed(name)
    assert sum(name in line for line in lines) == 1
    assert max(map(len, lines)) <= 80
    for number in ("1.99", "2.50", "0.80", "0.90"):
        assert any(number in line for line in lines)


def test_a_name_too_long_for_a_line_is_folded_and_not_cut():
    lines = printed("a" * 60 + ".toml")
    assert sum(line.count("a") for line in lines[4:]) >= 60
    assert max(map(len, lines)) <= 80 and "…" not in "".join(lines)
