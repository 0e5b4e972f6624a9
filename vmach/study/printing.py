"""Figures of a study for people."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from vmach.study.capability import FEWEST_DRAWS

__all__ = ["print_performance"]


def print_performance(console: Console, rows: Sequence[Mapping[str, Any]]) -> None:
    """Print Pp and Ppk of the drawn parts; nothing without rows."""
    if not rows:
        return
    # what every case has alike says nothing in a table
    first = rows[0]["case"]
    varied = [key for key in first if any(row["case"].get(key) != first[key] for row in rows)]
    table = Table(title="performance of the drawn parts, ISO 22514-2")
    for heading in (*varied, "feature", "drawing"):
        table.add_column(heading)
    for heading in ("draws", "50 %, mm", "Pp", "Ppk"):
        table.add_column(heading, justify="right")
    for row in rows:
        case = [str(row["case"].get(key, "-")) for key in varied]
        figures = ["-" if row[key] is None else f"{row[key]:.2f}" for key in ("Pp", "Ppk")]
        middle = f"{row['quantiles_mm'][1]:.4f}"
        table.add_row(*case, row["feature"], row["callout"], str(row["draws"]), middle, *figures)
    console.print(table)
    if all(row["draws"] < FEWEST_DRAWS for row in rows):
        text = f"Pp and Ppk need {FEWEST_DRAWS} draws: draws = {FEWEST_DRAWS} in the study"
        console.print(text, highlight=False, markup=False, soft_wrap=True)
