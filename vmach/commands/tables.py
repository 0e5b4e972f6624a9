"""``vmach tables``: compensation tables for controls, and what they leave."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer
from typer.core import TyperCommand

from vmach.base.progress import progress_bar
from vmach.base.terminal import console
from vmach.base.units import mm_from_um
from vmach.base.variant import Variant
from vmach.commands.options import AsJson, Control, Model
from vmach.errors import InputError
from vmach.files.atomic import atomic_folder, check_folder

if TYPE_CHECKING:
    from vmach.controller_tables import MadeTables
    from vmach.controller_tables.table_task import TableTask

__all__ = ["HelpWithFormats", "tables"]

_FIGURES, _README = "tables.json", "README.md"


class HelpWithFormats(TyperCommand):
    """Its help says what every format holds; they are loaded only when it is asked for."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        from vmach.controller_tables import FORMATS

        formats = (
            f"{name}: {one.title}. Holds {one.holds}; not {one.lacks}."
            for name, one in FORMATS.items()
        )
        self.help = "\n\n".join([self.help or "", *formats])
        super().format_help(ctx, formatter)


def tables(
    job: Annotated[
        Path | None,
        typer.Argument(metavar="[JOB]", help="job.toml: tables for its program and effects"),
    ] = None,
    out: Annotated[Path, typer.Option("-o", "--out", help="folder for the tables")] = (
        Path("tables")
    ),
    machine: Annotated[
        Path | None, typer.Option(help="machine.toml: tables for its whole measured volume")
    ] = None,
    formats: Annotated[
        str, typer.Option("--format", help="names, separated by commas, or all")
    ] = "all",
    model: Model = Variant.ABBE,
    tool_length: Annotated[
        float | None, typer.Option(min=0.0, max=1e4, help="with --machine: nose to tip along Z, mm")
    ] = None,
    tolerance_um: Annotated[
        float, typer.Option(help="of straight lines between entries; sets their number")
    ] = 0.2,
    comp_type: Annotated[int, typer.Option(min=0, max=1, help="LinuxCNC's COMP_FILE_TYPE")] = 0,
    cec_entries: Annotated[
        Literal["correction", "error"], typer.Option(help="sign of SINUMERIK's CEC entries")
    ] = "correction",
    as_json: AsJson = False,
    control: Control = None,
) -> None:
    """Write compensation tables for controls and verify them."""
    from vmach.controller_tables import make_tables
    from vmach.controller_tables.figures import tables_figures
    from vmach.controller_tables.printing import print_tables, tables_readme

    if not 0 < tolerance_um < float("inf"):
        raise InputError(f"--tolerance-um {tolerance_um:g}", accepted="above 0")
    names = _format_names(formats)
    tolerance_mm = mm_from_um(tolerance_um)
    task = _task(job, machine, model, tool_length=tool_length, tolerance_mm=tolerance_mm)
    check_folder(out, [*names, _FIGURES, _README], inputs=task.inputs)
    options = {"comp_type": comp_type, "cec_entries": cec_entries}
    with progress_bar() as progress, atomic_folder(out) as folder:
        made = make_tables(task, folder, formats=names, options=options, progress=progress)
        made = [replace(one, files=_relative(one, folder)) for one in made]
        figures = tables_figures(task, made)
        (folder / _FIGURES).write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
        (folder / _README).write_text(tables_readme(figures), encoding="utf-8")
    if as_json:
        print(json.dumps(figures, indent=1))
        return
    print_tables(console(), figures)
    print(f"results in {out}: a folder for each format, README.md, tables.json")


def _format_names(text: str) -> list[str]:
    from vmach.controller_tables import FORMATS

    names = list(FORMATS) if text == "all" else [name.strip() for name in text.split(",")]
    unknown = [name for name in names if name not in FORMATS]
    if unknown:
        raise InputError(f"--format {unknown[0]}", accepted="all, " + ", ".join(FORMATS))
    return list(dict.fromkeys(names))


def _task(
    job: Path | None,
    machine: Path | None,
    model: Variant,
    *,
    tool_length: float | None,
    tolerance_mm: float,
) -> TableTask:
    from vmach.controller_tables.table_task import task_of_job, task_of_machine
    from vmach.job import read_job
    from vmach.plausibility import admitted_machine

    if (job is None) == (machine is None):
        given = "neither" if job is None else f"{job} and {machine}"
        raise InputError(
            f"tables are made for a job or for a machine; there is {given}",
            accepted="JOB, or --machine FILE",
        )
    if model is Variant.NONE:
        raise InputError(f"--model {model} has no error to compensate", accepted="abbe, htm")
    if job is None and machine is not None:
        length = 0.0 if tool_length is None else tool_length
        return task_of_machine(
            admitted_machine(machine), model, tool_length_mm=length, tolerance_mm=tolerance_mm
        )
    if tool_length is not None:
        what = f"--tool-length {tool_length:g} goes with --machine"
        raise InputError(what, hint="a job names its own tools")
    assert job is not None
    return task_of_job(read_job(job), model, tolerance_mm=tolerance_mm)


def _relative(made: MadeTables, folder: Path) -> tuple[Path, ...]:
    return tuple(path.relative_to(folder) for path in made.files)
