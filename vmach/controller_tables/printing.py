"""The figures of compensation tables as text: for the terminal, and to go with the tables."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.table import Table

__all__ = ["print_tables", "tables_readme"]

_BEFORE_USE = (
    "Before use: check the sign with one table and one move; see the page controller-tables in "
    "vmach's documentation for what is certain of each format."
)


def tables_readme(figures: dict[str, Any]) -> str:
    """Markdown that goes with the tables, from the figures of ``tables.json``."""
    lines = [
        f"# Compensation tables for {figures['machine']}",
        "",
        f"Made by vmach, model {figures['model']}, judged over the {figures['judged']}, tool "
        f"length {figures['tool_length_mm']:g} mm. Every file was read back and applied as the "
        "control would; the figures are what is left of the error of the tool tip.",
        "",
        "| format | rms before, um | rms after, um | largest before | largest after | left |",
        "|---|---|---|---|---|---|",
    ]
    for name, one in figures["formats"].items():
        before, after = one["before_um"], one["after_um"]
        lines.append(
            f"| {name} | {before['rms']:.2f} | {after['rms']:.2f} | {before['largest']:.2f} | "
            f"{after['largest']:.2f} | {one['share_left_percent']:.1f} % |"
        )
    lines += ["", *(f"* {note}" for note in figures["notes"])]
    for name, one in figures["formats"].items():
        lines += ["", f"## {name}: {one['title']}", "", f"Holds {one['holds']}."]
        lines += [f"Does not hold {one['does_not_hold']}.", ""]
        lines += [f"Files: {', '.join(one['files'])}"]
        if one["left_by_component_um"]:
            left = ", ".join(
                f"{key} {value['after_rms']:.2f} (of {value['before_rms']:.2f})"
                for key, value in one["left_by_component_um"].items()
            )
            lines += ["", f"Left, rms in um: {left}."]
    return "\n".join([*lines, "", _BEFORE_USE]) + "\n"


def print_tables(console: Console, figures: dict[str, Any]) -> None:
    """Print the figures of ``tables.json`` for people."""
    table = Table(title=f"error of the tool tip over the {figures['judged']}, um: before -> after")
    for heading in ("format", "rms", "largest"):
        table.add_column(heading, no_wrap=True)
    table.add_column("most of what is left")
    for name, one in figures["formats"].items():
        before, after = one["before_um"], one["after_um"]
        rows = (f"{before[key]:.2f} -> {after[key]:.2f}" for key in ("rms", "largest"))
        table.add_row(name, *rows, " ".join(list(one["left_by_component_um"] or {})[:4]))
    console.print(table)
    for note in figures["notes"]:
        console.print(f"note: {note}", highlight=False, markup=False)
