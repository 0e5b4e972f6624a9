"""``vmach compensate JOB -o OUT.nc``: the program moved against the predicted error."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from vmach.compensation.compensate import Compensation
from vmach.compensation.compensate import compensate as compensate_job
from vmach.effects import read_effects
from vmach.errors import InputError
from vmach.job import read_job
from vmach.machine import Variant
from vmach.report import atomic_file
from vmach.units import um_from_mm

__all__ = ["compensate"]


def compensate(
    job: Annotated[Path, typer.Argument(metavar="JOB", help="job.toml, or the folder it is in")],
    out: Annotated[Path, typer.Option("-o", "--out", help="NC program to write")],
    model: Annotated[Variant, typer.Option(help="arms of the machine's angular errors")] = (
        Variant.ABBE
    ),
    resolution_mm: Annotated[float, typer.Option(help="of the target control")] = 1e-3,
    tolerance_um: Annotated[
        float, typer.Option(help="bend of the error from which a point is inserted")
    ] = 90e-3,
    limit_um: Annotated[float, typer.Option(help="largest correction accepted")] = 500.0,
    dialect: Annotated[
        str | None,
        typer.Option(help="target control: linuxcnc, fanuc, haas, siemens, heidenhain"),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print the figures as JSON")] = False,
) -> None:
    """Move the program against the predicted error of the tool, and verify it."""
    _check_numbers(resolution_mm, tolerance_um, limit_um)
    read = read_job(job)
    if out.resolve() in {path.resolve() for _, path in read.files()}:
        raise InputError(f"{out} is a file of the job", accepted="another name for the result")
    found = compensate_job(
        read,
        read_effects(read.effects, file=read.path, job=read),
        variant=model,
        resolution_mm=resolution_mm,
        tolerance_mm=1e-3 * tolerance_um,
        limit_mm=1e-3 * limit_um,
        dialect=dialect,
    )
    with atomic_file(out) as temporary:
        temporary.write_bytes(found.text)
    figures = _figures(found)
    if as_json:
        print(json.dumps(figures, indent=1))
        return
    for name in ("before", "before_rounding", "after"):
        largest, mean = figures[f"{name}_largest_um"], figures[f"{name}_mean_um"]
        print(f"{name.replace('_', ' '):16} largest {largest:.3f} um, mean {mean:.3f} um")
    print(f"largest correction {figures['largest_correction_um']:.2f} um")
    print(f"{figures['growth']:.2f} times the blocks; {found.arcs_kept} of {found.arcs} arcs kept")
    for reason in sorted(set(found.expanded_lines.values())):
        lines = [k for k, why in found.expanded_lines.items() if why == reason]
        print(f"written out ({reason}): lines {_shown(lines)}")
    for line in found.left_lines:
        print(f"line {line} stays: machine coordinates or reference point")
    print("the tilt of the tool stays: three axes cannot correct it")
    print(f"program in {out}")


def _shown(lines: list[int]) -> str:
    """The first lines of many."""
    first = ", ".join(map(str, sorted(lines)[:10]))
    return first + (f" ... ({len(lines)} lines)" if len(lines) > 10 else "")


def _check_numbers(resolution_mm: float, tolerance_um: float, limit_um: float) -> None:
    if not 1e-6 <= resolution_mm <= 0.1:
        raise InputError(f"--resolution-mm {resolution_mm:g}", accepted="1e-6 .. 0.1 mm")
    if not tolerance_um > 0:
        raise InputError(f"--tolerance-um {tolerance_um:g}", accepted="above 0")
    if not limit_um > 0:
        raise InputError(f"--limit-um {limit_um:g}", accepted="above 0")


def _figures(found: Compensation) -> dict[str, Any]:
    residuals = {"before": found.before, "before_rounding": found.unrounded, "after": found.after}
    figures: dict[str, Any] = {}
    for name, residual in residuals.items():
        figures[f"{name}_largest_um"] = um_from_mm(residual.largest_mm)
        figures[f"{name}_mean_um"] = um_from_mm(residual.mean_mm)
    worst = int(found.after.distance_mm.argmax()) if len(found.after.distance_mm) else None
    return figures | {
        "expanded_lines": {str(line): why for line, why in sorted(found.expanded_lines.items())},
        "worst_line_after": None if worst is None else int(found.after.line[worst]),
        "largest_correction_um": um_from_mm(found.largest_correction_mm),
        "growth": found.growth,
        "arcs": found.arcs,
        "arcs_kept": found.arcs_kept,
        "left_lines": list(found.left_lines),
        "swallowed_words": found.swallowed,
        "uncorrected": ["tilt of the tool"],
    }
