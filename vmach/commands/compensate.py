"""``vmach compensate JOB -o OUT.nc``: the program moved against the predicted error."""

from __future__ import annotations

import json
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from vmach.base.progress import progress_bar
from vmach.base.stage_clock import StageClock
from vmach.base.units import mm_from_um
from vmach.base.variant import Variant
from vmach.commands.options import (
    HERE,
    Control,
    JobPath,
    Model,
    command_line,
    input_files,
    tell_doubts,
)
from vmach.errors import InputError
from vmach.files.atomic import atomic_file, check_outputs
from vmach.files.ending import check_ending
from vmach.files.together import together

if TYPE_CHECKING:
    from vmach.compensation.aim.surface import Surface
    from vmach.job import Job

__all__ = ["Aim", "compensate"]


class Aim(StrEnum):
    """What shall be in its nominal place."""

    TOOL = "tool"
    PART = "part"


def compensate(
    *,
    job: JobPath = HERE,
    out: Annotated[Path, typer.Option("-o", "--out", help="NC program to write")],
    model: Model = Variant.ABBE,
    aim: Annotated[
        Aim,
        typer.Option(
            help="tool: the tip on its nominal path; part: the path is shifted so that the "
            "deviations of the part are centred"
        ),
    ] = Aim.TOOL,
    resolution_mm: Annotated[float, typer.Option(help="of the target control")] = 1e-3,
    tolerance_um: Annotated[
        float, typer.Option(help="largest residual before rounding; points are inserted for it")
    ] = 0.1,
    limit_um: Annotated[float, typer.Option(help="largest correction accepted")] = 500.0,
    residual_limit_um: Annotated[
        float, typer.Option(help="largest residual accepted in the written program")
    ] = 5.0,
    dialect: Annotated[
        str | None,
        typer.Option(help="control that reads the written program, by the names of --control"),
    ] = None,
    report: Annotated[Path | None, typer.Option(help="HTML file to write")] = None,
    json_: Annotated[bool, typer.Option("--json", help="print the figures as JSON")] = False,
    control: Control = None,
) -> None:
    """Move the program against the predicted error."""
    from gcode import dialect_of
    from vmach.compensation.aim.surface import check_surface, read_surface
    from vmach.compensation.compensate import compensate as compensate_job
    from vmach.compensation.figures import as_json, as_text
    from vmach.compensation.report import write_compensation_report
    from vmach.effects import read_effects
    from vmach.job import read_job
    from vmach.program_text import target_control

    _check_numbers(resolution_mm, {"--tolerance-um": tolerance_um, "--limit-um": limit_um,
                                   "--residual-limit-um": residual_limit_um})  # fmt: skip
    read = read_job(job)
    target_control(dialect_of(read.program, read.dialect), dialect, file=read.program)
    check_outputs([out, report], inputs=input_files(read))
    check_ending(report, [".html", ".htm"], what="a report")
    tell_doubts(read)
    effects = read_effects(read.effects, file=read.path, job=read)
    with progress_bar() as progress:
        clock = StageClock(progress)
        with clock.stage("surface"):
            surface = read_surface(read, with_aim=True)
            _check_surface(surface, read, {"report on": report, "aim at": aim is Aim.PART})
            points = None if surface is None else surface.aim
        with clock.stage("move") as step:
            found = compensate_job(
                read,
                effects,
                variant=model,
                resolution_mm=resolution_mm,
                tolerance_mm=mm_from_um(tolerance_um),
                limit_mm=mm_from_um(limit_um),
                residual_limit_mm=mm_from_um(residual_limit_um),
                dialect=dialect,
                aim_points=points if aim is Aim.PART else None,
                round_points=points,
                progress=step,
            )
        with clock.stage("verify"):
            checked = None if surface is None else check_surface(
                read, found.text, surface, effects=effects, variant=model
            )  # fmt: skip
    with together():
        with atomic_file(out) as temporary:
            temporary.write_bytes(found.text)
        if report is not None and checked is not None:
            write_compensation_report(
                report, found, checked, job=read, model=model, command=command_line()
            )
    if json_:
        print(json.dumps(as_json(found, checked), indent=1))
        return
    print("\n".join(as_text(found, checked)))
    print(f"program in {out}" + (f", report in {report}" if report else ""))


def _check_numbers(resolution_mm: float, above_zero: dict[str, float]) -> None:
    if not 1e-6 <= resolution_mm <= 0.1:
        raise InputError(f"--resolution-mm {resolution_mm:g}", accepted="1e-6 .. 0.1 mm")
    for name, value in above_zero.items():
        if not value > 0:
            raise InputError(f"{name} {value:g}", accepted="above 0")


def _check_surface(surface: Surface | None, job: Job, wanted: dict[str, object]) -> None:
    for purpose, is_wanted in wanted.items():
        if is_wanted and surface is None:
            raise InputError(
                f"there is no surface to {purpose}",
                file=job.path,
                accepted="nominal = an STL or STEP file, or [stock]",
            )
