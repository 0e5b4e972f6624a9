"""``vmach tables``: compensation tables for controls, and what they leave."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from rich.console import Console
from rich.table import Table

from vmach.atomic import atomic_folder
from vmach.controller_tables.make_tables import MadeTables, Residual, make_tables
from vmach.controller_tables.table_formats import FORMATS
from vmach.controller_tables.table_task import TableTask, task_of_job, task_of_machine
from vmach.errors import InputError
from vmach.job import read_job
from vmach.machine import Machine, Variant, read_machine
from vmach.progress import progress_bar
from vmach.units import um_from_mm

__all__ = ["tables"]

#: components that keep less than this share of all that is left are not listed
_LISTED_SHARE = 0.02
_BEFORE_USE = (
    "Before use: check the sign with one table and one move; see the page controller-tables in "
    "vmach's documentation for what is certain of each format."
)
_HELP = "\n\n".join(
    [
        "Compensation tables for controls, read back and applied as the control would.",
        *(
            f"{name}: {one.title}. Holds {one.holds}; not {one.lacks}."
            for name, one in FORMATS.items()
        ),
    ]
)


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
    model: Annotated[Variant, typer.Option(help="arms of the machine's angular errors")] = (
        Variant.ABBE
    ),
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
    as_json: Annotated[bool, typer.Option("--json", help="print the figures as JSON")] = False,
) -> None:
    if not 0 < tolerance_um < float("inf"):
        raise InputError(f"--tolerance-um {tolerance_um:g}", accepted="above 0")
    names = _format_names(formats)
    task = _task(job, machine, model, tool_length=tool_length, tolerance_mm=1e-3 * tolerance_um)
    options = {"comp_type": comp_type, "cec_entries": cec_entries}
    with progress_bar() as progress, atomic_folder(out) as folder:
        made = make_tables(task, folder, formats=names, options=options, progress=progress)
        made = [replace(one, files=_relative(one, folder)) for one in made]
        figures = _figures(task, made)
        (folder / "tables.json").write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
        (folder / "README.md").write_text(_readme(figures), encoding="utf-8")
    if as_json:
        print(json.dumps(figures, indent=1))
        return
    _print(Console(), figures)
    print(f"results in {out}: a folder for each format, README.md, tables.json")


tables.__doc__ = _HELP


def _format_names(text: str) -> list[str]:
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
    if (job is None) == (machine is None):
        raise InputError(
            "tables are made for a job or for a machine", accepted="JOB, or --machine FILE"
        )
    if model is Variant.NONE:
        raise InputError("--model none has no error to compensate", accepted="abbe, htm")
    if job is None:
        length = 0.0 if tool_length is None else tool_length
        return task_of_machine(
            read_machine(machine), model, tool_length_mm=length, tolerance_mm=tolerance_mm
        )
    if tool_length is not None:
        raise InputError("--tool-length goes with --machine", hint="a job names its own tools")
    return task_of_job(read_job(job), model, tolerance_mm=tolerance_mm)


def _relative(made: MadeTables, folder: Path) -> tuple[Path, ...]:
    return tuple(path.relative_to(folder) for path in made.files)


def _figures(task: TableTask, made: list[MadeTables]) -> dict[str, Any]:
    low, high = task.volume.low_mm, task.volume.high_mm
    return {
        "schema": 1,
        "machine": task.machine.name,
        "model": str(task.variant),
        "judged": "volume" if task.program is None else "program",
        "tool_length_mm": task.tool_length_mm,
        "volume_mm": {axis: [low[k], high[k]] for k, axis in enumerate("XYZ")},
        "notes": _notes(task),
        "formats": {one.name: _format_figures(one) for one in made},
    }


def _notes(task: TableTask) -> list[str]:
    machine = task.machine
    notes = ["the tilt of the tool stays: three axes cannot correct it"]
    travel = machine.travel_mm
    if (travel[0] < task.volume.low_mm).any() or (travel[1] > task.volume.high_mm).any():
        notes.append("tables end where the measured errors end; the travel goes on, and there the "
                     "controls hold the last entry")  # fmt: skip
    reversal = _reversal_um(machine)
    if reversal and not machine.separate_directions:
        notes.append(
            f"forward and backward tables differ by up to {reversal:.2f} um; the entries hold "
            'their mean. [tables] directions = "separate" in the machine file keeps both'
        )
    return notes


def _reversal_um(machine: Machine) -> float:
    linear = [one for one in machine.components.values() if not one.is_angle]
    return um_from_mm(max((float(abs(c.forward - c.backward).max()) for c in linear), default=0.0))


def _format_figures(made: MadeTables) -> dict[str, Any]:
    longer = made.with_longer_tool
    return {
        "title": made.format.title,
        "holds": made.format.holds,
        "does_not_hold": made.format.lacks,
        "files": [str(path) for path in made.files],
        "entries_xyz": list(made.entries),
        "before_um": _residual_um(made.before),
        "after_um": _residual_um(made.after),
        "share_left_percent": 100.0 * made.after.rms_mm / max(made.before.rms_mm, 1e-12),
        "tool_100_mm_longer_um": longer
        and {"before": _residual_um(longer[0]), "after": _residual_um(longer[1])},
        "left_by_component_um": _left_um(made),
    }


def _residual_um(residual: Residual) -> dict[str, Any]:
    return {
        "mean": um_from_mm(residual.mean_mm),
        "rms": um_from_mm(residual.rms_mm),
        "largest": um_from_mm(residual.largest_mm),
        "largest_abs_xyz": um_from_mm(residual.largest_xyz_mm).tolist(),
    }


def _left_um(made: MadeTables) -> dict[str, dict[str, float]] | None:
    """Components that keep a share worth naming, largest first."""
    if made.left is None:
        return None
    whole = sum(after**2 for _, after in made.left.values()) ** 0.5
    rows = sorted(made.left.items(), key=lambda item: -item[1][1])
    return {
        name: {"before_rms": um_from_mm(before), "after_rms": um_from_mm(after)}
        for name, (before, after) in rows
        if after > _LISTED_SHARE * whole and um_from_mm(after) > 1e-3
    }


def _readme(figures: dict[str, Any]) -> str:
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


def _print(console: Console, figures: dict[str, Any]) -> None:
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
