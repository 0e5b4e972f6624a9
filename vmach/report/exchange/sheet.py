"""PDF: one to three pages to print and sign."""

from __future__ import annotations

import io
import textwrap
from pathlib import Path

from matplotlib.backends.backend_pdf import FigureCanvasPdf, PdfPages
from matplotlib.figure import Figure
from PIL import Image

from vmach.features.result import FeatureResult, Value
from vmach.features.verdict import Verdict
from vmach.report.exchange.formats import reported
from vmach.report.figures.features import COVERAGE, spread_text
from vmach.report.result import RunRecord

__all__ = ["content"]

#: A4, upright, inch; rows of a page; pages with a table
_PAGE_INCH, _ROWS, _TABLE_PAGES = (8.27, 11.69), 40, 2
_INK, _GREY, _LINE = "#1d2125", "#5c646c", "#c9ced3"
_COLOURS = {Verdict.CONFORMS: "#2f7d4f", Verdict.FAILS: "#b3261e", Verdict.OPEN: "#9a6700"}
#: left edges of the columns as shares of the page's width, and their headings
_COLUMNS = ((0.07, "feature"), (0.27, "requirement"), (0.49, "limits, mm"),
            (0.65, "found, mm"), (0.83, "verdict"))  # fmt: skip
_TOP, _PITCH = 0.83, 0.0175


def content(run: RunRecord, *, picture: Path | None = None, logo: Path | None = None) -> bytes:
    """The document: head, picture and counts, then the table, a line to sign at the end."""
    rows = list(run.features)
    kept = rows[: _ROWS * _TABLE_PAGES]
    tables = [kept[k : k + _ROWS] for k in range(0, len(kept), _ROWS)] or [[]]
    data = io.BytesIO()
    count = len(tables) + (picture is not None)
    with PdfPages(data, metadata={"CreationDate": None, "Creator": "vmach"}) as pages:
        number = 0
        if picture is not None:
            number += 1
            pages.savefig(_first_page(run, picture, logo, f"{number} / {count}"))
        for table in tables:
            number += 1
            figure = _table_page(run, table, logo, f"{number} / {count}")
            if number == count:
                _sign(figure, len(rows) - len(kept))
            pages.savefig(figure)
    return data.getvalue()


def _page(run: RunRecord, logo: Path | None, number: str) -> Figure:
    """An empty page with its head and foot."""
    figure = Figure(_PAGE_INCH)
    FigureCanvasPdf(figure)
    left = 0.07
    if logo is not None:
        with Image.open(logo) as image:
            width = min(0.2, 0.05 * image.width / image.height * _PAGE_INCH[1] / _PAGE_INCH[0])
            panel = figure.add_axes((0.93 - width, 0.92, width, 0.05))
            panel.imshow(image.convert("RGB"))
        panel.set_axis_off()
    figure.text(left, 0.945, _plain(run.part or run.title), size=16, weight="bold", color=_INK)
    head = [
        f"serial {run.serial}" if run.serial else "",
        f"revision {run.revision}" if run.revision else "",
        run.started_at[:10],
        f"machine {run.facts['machine']}" if run.facts.get("machine") else "",
    ]
    told = "   ·   ".join(_plain(part) for part in head if part)
    figure.text(left, 0.925, told, size=9, color=_GREY)
    figure.text(left, 0.03, "vmach", size=8, color=_GREY)
    figure.text(0.93, 0.03, number, size=8, color=_GREY, ha="right")
    figure.add_artist(_rule(0.91))
    return figure


def _rule(height: float):
    from matplotlib.lines import Line2D

    return Line2D((0.07, 0.93), (height, height), color=_LINE, lw=0.8)


def _first_page(run: RunRecord, picture: Path, logo: Path | None, number: str) -> Figure:
    figure = _page(run, logo, number)
    with Image.open(picture) as image:
        height = 0.86 * image.height / image.width * _PAGE_INCH[0] / _PAGE_INCH[1]
        height = min(height, 0.5)
        panel = figure.add_axes((0.07, 0.88 - height, 0.86, height))
        panel.imshow(image.convert("RGB"), aspect="equal", interpolation="none")
    panel.set_axis_off()
    below = 0.88 - height - 0.04
    counts = {verdict: 0 for verdict in Verdict}
    for result in run.features:
        value = reported(result)
        if value is not None:
            counts[value.verdict] += 1
    for k, (verdict, count) in enumerate(counts.items()):
        figure.text(0.07 + 0.3 * k, below, str(count), size=20, weight="bold",
                    color=_COLOURS[verdict] if count else _GREY)  # fmt: skip
        figure.text(0.07 + 0.3 * k, below - 0.018, str(verdict), size=9, color=_GREY)
    notes = [f"· {line}" for line in run.warnings[:8]]
    text = "\n".join(line for note in notes for line in textwrap.wrap(_plain(note), 105))
    figure.text(0.07, below - 0.05, text, size=8, color=_GREY, va="top", linespacing=1.4)
    return figure


def _table_page(
    run: RunRecord, rows: list[FeatureResult], logo: Path | None, number: str
) -> Figure:
    figure = _page(run, logo, number)
    has_measured = any(result.measured for result in run.features)
    told = "measured" if has_measured else "predicted"
    drawn = any(r.predicted and r.predicted.interval_mm for r in run.features)
    spread = "with intervals of 95 % from draws" if drawn else f"± U (k = {COVERAGE:g})"
    told = f"Values are {told}, {spread}; verdict after ISO 14253-1"
    figure.text(0.07, 0.885, told, size=8, color=_GREY)
    for left, heading in _COLUMNS:
        figure.text(left, _TOP + 0.025, heading, size=8, weight="bold", color=_INK)
    figure.add_artist(_rule(_TOP + 0.018))
    for k, result in enumerate(rows):
        _row(figure, result, _TOP - k * _PITCH)
    return figure


def _row(figure: Figure, result: FeatureResult, height: float) -> None:
    value = reported(result)
    verdict = result.reason if value is None else str(value.verdict)
    lower = "≤ " if result.lower_mm is None else f"{result.lower_mm:.4f} … "
    cells = [result.feature, result.title, f"{lower}{result.upper_mm:.4f}", _found(value), verdict]
    widths = (26, 30, 24, 24, 24)
    for (left, _), text, width in zip(_COLUMNS, cells, widths, strict=True):
        short = text if len(text) <= width else text[: width - 1] + "…"
        colour = _COLOURS[value.verdict] if text is verdict and value is not None else _INK
        figure.text(left, height, _plain(short), size=7.5, color=colour)


def _found(value: Value | None) -> str:
    if value is None:
        return "–"
    spread = spread_text(value)
    return f"{value.value_mm:.4f}{spread}"


def _sign(figure: Figure, missing: int) -> None:
    """Lines for date and signature."""
    if missing:
        figure.text(0.07, 0.105, f"{missing} more rows in features.csv", size=8, color=_GREY)
    from matplotlib.lines import Line2D

    for left, right, word in ((0.07, 0.3, "date"), (0.4, 0.93, "name and signature")):
        figure.add_artist(Line2D((left, right), (0.075, 0.075), color=_INK, lw=0.8))
        figure.text(left, 0.06, word, size=8, color=_GREY)


def _plain(text: str) -> str:
    """Keep matplotlib from reading mathematics in a user's text."""
    return text.replace("$", r"\$")
