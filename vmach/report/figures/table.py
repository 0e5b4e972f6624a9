"""Columns of deviations side by side on a terminal."""

from __future__ import annotations

import math
import textwrap

from rich.table import Table
from rich.text import Text

from vmach.base.units import um_from_mm
from vmach.report.figures.statistics import column_statistics
from vmach.report.result import InspectedPoints, RunRecord

__all__ = ["columns_table"]

#: characters of a column's heading, where there are up to three and where there are more
_WIDE, _NARROW = 16, 12


def columns_table(points: InspectedPoints, run: RunRecord) -> Table:
    """Return a rich table of the points' columns, lengths in um; fits 80 columns up to four."""
    table = Table(title=Text(run.title), title_justify="left", caption_justify="left")
    table.caption = "positive: material left, negative: too much removed"
    table.add_column("um", no_wrap=True)
    width = _WIDE if len(points.columns) <= 3 else _NARROW
    for column in points.columns:
        heading = textwrap.fill(column.label, width, break_long_words=False)
        table.add_column(Text(heading), justify="right", no_wrap=True)
    for label, cells in _rows(points, run):
        table.add_row(label, *cells)
    return table


def _rows(points: InspectedPoints, run: RunRecord) -> list[tuple[str, list[str]]]:
    every = [column_statistics(column, run.tolerance_mm) for column in points.columns]
    rows = [
        ("RMS", [_um(s.rms_mm) for s in every]),
        ("mean", [_um(s.mean_mm, "+") for s in every]),
        ("minimum", [_um(s.min_mm, "+") for s in every]),
        ("maximum", [_um(s.max_mm, "+") for s in every]),
    ]
    remainders = [column.remainder_rms_mm for column in points.columns]
    if any(remainder is not None for remainder in remainders):
        rows.append(("measured − predicted", [_um(remainder) for remainder in remainders]))
    shares = [f"{100 * s.outside_share:.2f} %" if s.count else "–" for s in every]
    rows.append((f"outside ±{um_from_mm(run.tolerance_mm):g} um", shares))
    rows.append(("points cut", [str(s.count) for s in every]))
    rows.append(("points not cut", [str(len(points) - s.count) for s in every]))
    return rows


def _um(length_mm: float | None, sign: str = "-") -> str:
    if length_mm is None or not math.isfinite(length_mm):
        return "–"
    length_um = um_from_mm(length_mm)
    return f"{length_um:{sign}.3f}" if abs(length_um) >= 5e-4 else "0.000"
