"""iso230.html: for every table a sheet with diagram, figures, uncertainty and a line to sign.

Source: ISO 230-2:2014, presentation of results (date, machine, axis, runs and targets, figures with
their uncertainty, diagram).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from vmach.base.units import with_micro_sign
from vmach.iso230.figures import EvaluatedTable
from vmach.report.page.kit import asset, render_page, style_sheet
from vmach.report.page.svg_plot import Frame, Plot

__all__ = ["iso230_page"]

_HERE = Path(__file__).parent
#: what the figures are called on the sheet, and in which direction of approach
_MEANINGS = {
    "A": "accuracy",
    "R": "repeatability",
    "E": "systematic deviation",
    "M": "mean bidirectional deviation",
    "B": "reversal",
}
_WAYS = {"forward": "↑", "backward": "↓", "mean": "mean"}


def iso230_page(
    report: Mapping[str, Any],
    axes: Sequence[EvaluatedTable],
    *,
    machine: str,
    serial: str,
    date: str,
    command: str,
) -> str:
    """The page; it asks the network for nothing.

    Parameters
    ----------
    report : mapping
        The figures, as in ``iso230.json``.
    axes : sequence of EvaluatedTable
    machine, serial, date : str
        For the head of every sheet; `date` of the measurement. What is empty can be written in.
    command : str
        What was typed.
    """
    sheets = [
        {
            "name": axis.name,
            "entry": report["tables"][axis.name],
            "unit": with_micro_sign(axis.unit),
            "rows": _rows(report["tables"][axis.name]),
            "diagram": _diagram(axis),
            "ranges": sorted(axis.result.ends()),
        }
        for axis in axes
    ]
    return render_page(
        _HERE / "page.html.jinja",
        report=report,
        sheets=sheets,
        machine=machine,
        serial=serial,
        date=date,
        started_at=datetime.now(UTC).isoformat(timespec="seconds"),
        command=command,
        css=style_sheet(asset("page.css", _HERE)),
    )


def _rows(entry: Mapping[str, Any]) -> list[tuple[str, str, str, str]]:
    """Symbol, meaning, value and U of every figure."""
    spread = entry.get("U_k2", {})
    rows = []
    for name, value in entry["figures"].items():
        letter, _, way = name.partition("_")
        shown = "–" if value is None else f"{value:.2f}".replace("-", "−")
        u = f"{spread[name]:.1f}" if name in spread and value is not None else ""
        meaning = _MEANINGS.get(letter, "") + (f", {way}" if way else "")
        rows.append((f"{letter} {_WAYS.get(way, way)}".strip(), meaning, shown, u))
    return rows


def _diagram(axis: EvaluatedTable) -> Markup:
    """Readings, means of both directions, two standard deviations, mean of both, ranges E and A."""
    result, factor = axis.result, axis.factor
    runs, x = result.runs, result.runs.position_mm
    sides = (
        ("forward", factor * runs.forward, factor * result.mean_forward, result.s_forward),
        ("backward", factor * runs.backward, factor * result.mean_backward, result.s_backward),
    )
    ends = [values for _, readings, mean, _ in sides for values in (readings.ravel(), mean)]
    for _, _, mean, s in sides:
        if s is not None:
            ends += [mean - 2 * factor * s, mean + 2 * factor * s]
    every = np.concatenate(ends)
    every = every[np.isfinite(every)]
    margin = 0.06 * max(float(np.ptp(every)), 1e-6)
    low, high = float(np.min(every)) - margin, float(np.max(every)) + margin
    plot = Plot(Frame((float(x.min()), float(x.max())), (low, high), 760.0, 300.0, top=20.0))
    plot.x_axis(f"target position, {axis.position_unit}", zero="grid")
    plot.y_axis(f"deviation, {with_micro_sign(axis.unit)}")
    for name, readings, mean, s in sides:
        if s is not None:
            plot.bands([(x, mean - 2 * factor * s, mean + 2 * factor * s)], name)
        for run in readings:
            known = np.isfinite(run)
            plot.dots(x[known], run[known], name)
        plot.line(x, mean, name)
    plot.line(x, 0.5 * (sides[0][2] + sides[1][2]), "middle-line")
    for name, (lowest, highest) in result.ends().items():
        for end in (lowest, highest):
            plot.line(x[[0, -1]], np.full(2, factor * end), f"range-{name}")
    return plot.markup(f"Deviations of {axis.name} against the target position")
