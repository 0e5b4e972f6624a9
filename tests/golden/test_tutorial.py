"""What the tutorials print is what their commands print."""

from __future__ import annotations

import csv
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from vmach.cli import app

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")


def numbers(text):
    """Rows of a CSV, numbers as such."""
    rows = list(csv.reader(text.split()))
    return rows[0], [[float(cell) if cell != "cut" else cell for cell in row] for row in rows[1:]]


def test_predicted_points_are_those_of_the_page(tmp_path):
    (points,) = re.findall(r"<<END\n(id,.*?)END", PAGE, re.DOTALL)
    (printed,) = re.findall(r"\n((?:    \S+\n)+)", PAGE[PAGE.index("    id,deviation_um") - 1 :])[
        :1
    ]
    (tmp_path / "points.csv").write_text(points)
    words = ["predict", str(ROOT / "samples" / "iso10791_7" / "job.toml"), "--points"]
    run = CliRunner().invoke(app, [*words, str(tmp_path / "points.csv")])
    assert run.exit_code == 0, run.exception
    heading, rows = numbers(run.stdout)
    heading_of_page, rows_of_page = numbers(printed)
    assert heading == heading_of_page
    for row, of_page in zip(rows, rows_of_page, strict=True):
        for value, expected in zip(row, of_page, strict=True):
            assert value == (expected if expected == "cut" else pytest.approx(expected, rel=2e-4))


def test_the_effect_found_has_the_size_that_the_page_tells(tmp_path):
    page = (ROOT / "docs" / "tutorial-missing-effect.md").read_text(encoding="utf-8")
    (told,) = re.findall(r"reversal_um = .*\(u = .*95 %.*", page)
    run = CliRunner().invoke(app, ["diagnose", str(ROOT / "samples" / "missing_effect")])
    assert run.exit_code == 0, run.exception
    assert told in run.stdout
    blind = re.findall(r"(?:scale Z|servo_lag): below .*", page)
    assert len(blind) == 2 and all(line in run.stdout for line in blind)
