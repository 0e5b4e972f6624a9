"""``vmach iso230 DATA``: figures, diagrams and uncertainty of bidirectional runs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from vmach.base.progress import progress_bar
from vmach.base.stage_clock import Progress
from vmach.base.terminal import console
from vmach.commands.options import AsJson, command_line
from vmach.errors import InputError
from vmach.files.atomic import atomic_folder, check_folder

if TYPE_CHECKING:
    from vmach.iso230.figures import EvaluatedTable

__all__ = ["iso230"]

_FIGURES, _PAGE = "iso230.json", "iso230.html"


def iso230(
    data: Annotated[
        Path, typer.Argument(metavar="DATA", help="CSV of bidirectional runs, or a machine.toml")
    ],
    unit: Annotated[
        str | None, typer.Option(help="of a CSV's readings: um, urad, arcsec ...  [default: um]")
    ] = None,
    budget: Annotated[
        Path | None, typer.Option(help="TOML with the uncertainty contributors of the laser")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", help="folder for page, json and diagrams")
    ] = None,
    serial: Annotated[str, typer.Option(help="serial number of the machine, for the sheet")] = "",
    date: Annotated[str, typer.Option(help="date of the measurement, for the sheet")] = "",
    as_json: AsJson = False,
) -> None:
    """Evaluate laser runs after ISO 230-2, with uncertainty."""
    from vmach.iso230.budget_file import read_budget
    from vmach.iso230.figures import evaluated_tables, iso230_figures
    from vmach.iso230.printing import print_iso230

    contributors = read_budget(budget)
    axes = tuple(evaluated_tables(data, unit))
    if not axes:
        raise InputError("the machine has no error tables", file=data)
    if out is not None:
        names = [_FIGURES, _PAGE, *(f"{axis.name}.png" for axis in axes)]
        check_folder(out, names, inputs=[*_files_of(data), *([budget] if budget else [])])
    source = str(budget) if budget else "assumed: Table 8 of the KTH thesis"
    report = iso230_figures(data, axes, contributors, budget_source=source)
    if out is not None:
        from vmach.iso230.page.page import iso230_page

        with progress_bar() as progress:
            page = iso230_page(
                report, axes, machine=_machine_name(data), serial=serial, date=date,
                command=command_line(),
            )  # fmt: skip
            _write(out, report, axes, page, progress)
    if as_json:
        print(json.dumps(report, indent=1))
    else:
        print_iso230(console(), report)


def _files_of(data: Path) -> list[Path]:
    """The table, or the machine file and its tables."""
    from vmach.machine import read_machine

    return list(read_machine(data).files) if data.suffix == ".toml" else [data]


def _machine_name(data: Path) -> str:
    """Of a machine file; a single table does not say it."""
    from vmach.machine import read_machine

    return read_machine(data).name if data.suffix == ".toml" else ""


def _write(
    out: Path,
    report: dict[str, Any],
    axes: tuple[EvaluatedTable, ...],
    page: str,
    progress: Progress,
) -> None:
    """The page, the figures and one diagram a table, all files or none."""
    from vmach.iso230.diagram import draw_evaluation

    with atomic_folder(out) as folder:
        for count, axis in enumerate(axes):
            progress("draw", count, len(axes))
            picture = draw_evaluation(
                axis.result, title=f"{axis.name}, ISO 230-2", unit=axis.unit, factor=axis.factor,
                position_unit=axis.position_unit,
            )  # fmt: skip
            (folder / f"{axis.name}.png").write_bytes(picture)
        (folder / _PAGE).write_text(page, encoding="utf-8")
        (folder / _FIGURES).write_text(json.dumps(report, indent=1) + "\n")
