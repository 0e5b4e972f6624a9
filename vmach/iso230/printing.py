"""The figures of ISO 230-2 as text and tables."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.table import Table

__all__ = ["print_iso230"]


def print_iso230(console: Console, report: dict[str, Any]) -> None:
    """Print the figures of ``iso230.json`` for people."""
    names = ("A", "R", "E", "M", "B", "B_mean")
    table = Table(title=f"{report['standard']}  {report['data']}")
    for heading in ("table", "unit", "runs", *names):
        table.add_column(heading, justify="left" if heading in ("table", "unit") else "right")
    for name, entry in report["tables"].items():
        values = [entry["figures"][key] for key in names]
        cells = ["-" if value is None else f"{value:.2f}" for value in values]
        table.add_row(name, entry["unit"], str(entry["runs"]), *cells)
    console.print(table)
    if len(report["tables"]) == 1:
        (entry,) = report["tables"].values()
        _print_runs(console, entry)
    for name, entry in report["tables"].items():
        if "U_k2" in entry:
            parts = ", ".join(f"{key} {value:.1f}" for key, value in entry["U_k2"].items())
            _say(console, f"{name}: expanded uncertainty U (k = 2), um: {parts}")
    _say(console, f"uncertainty budget: {report['budget_um']['source']}")
    notes: dict[str, list[str]] = {}
    for name, entry in report["tables"].items():
        for note in entry["notes"]:
            notes.setdefault(note, []).append(name)
    for note, subjects in notes.items():
        _say(console, f"{' '.join(subjects)}: {note}")


def _print_runs(console: Console, entry: dict[str, Any]) -> None:
    """Every run by its number, where there is more than one."""
    if entry["runs"] < 2:
        return
    table = Table(title=f"runs beside the mean of all runs, {entry['unit']}")
    for heading in ("run", "direction", "readings", "mean", "largest", "at"):
        table.add_column(heading, justify="left" if heading == "direction" else "right")
    for own in entry["by_run"]:
        at = f"{own['at']:g}"
        figures = [f"{own[key]:+.2f}" for key in ("mean", "largest")]
        table.add_row(str(own["run"]), own["direction"], str(own["readings"]), *figures, at)
    console.print(table)


def _say(console: Console, text: str) -> None:
    console.print(text, highlight=False, markup=False, soft_wrap=True)
