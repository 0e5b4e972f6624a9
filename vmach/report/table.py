"""The variants side by side on a terminal."""

from __future__ import annotations

import math

from rich.table import Table
from rich.text import Text

from vmach.report.result import InspectedPoints, RunRecord
from vmach.report.statistics import variant_statistics
from vmach.units import um_from_mm

__all__ = ["variants_table"]


def variants_table(points: InspectedPoints, run: RunRecord) -> Table:
    """Return a rich table, one row a variant, lengths in um."""
    table = Table(title=Text(run.title), title_justify="left", caption_justify="left")
    table.caption = "µm; positive: material left, negative: too much removed"
    table.add_column("variant")
    tolerance_um = um_from_mm(run.tolerance_mm)
    headings = ("RMS", "mean", "smallest", "largest", f"outside ±{tolerance_um:g} µm", "cut")
    has_remainder = any(v.remainder_rms_mm is not None for v in points.variants)
    for heading in (*headings, "not cut", *(("measured − predicted, RMS",) * has_remainder)):
        table.add_column(heading, justify="right")
    for variant in points.variants:
        figures = variant_statistics(variant, run.tolerance_mm)
        cells = [
            _um(figures.rms_mm),
            *(_um(x, "+") for x in (figures.mean_mm, figures.min_mm, figures.max_mm)),
            f"{100 * figures.outside_share:.2f} %" if figures.count else "–",
            str(figures.count),
            str(len(points) - figures.count),
        ]
        if has_remainder:
            cells.append(_um(variant.remainder_rms_mm))
        table.add_row(Text(variant.label), *cells)
    return table


def _um(length_mm: float | None, sign: str = "-") -> str:
    if length_mm is None or not math.isfinite(length_mm):
        return "–"
    value_um = um_from_mm(length_mm)
    return (
        f"{value_um:{sign}.3f}"
        if value_um == 0 or abs(value_um) >= 1e-3
        else f"{value_um:{sign}.1e}"
    )
