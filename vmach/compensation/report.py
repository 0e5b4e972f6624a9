"""The report of a compensation: the page of a run, with the part before and after."""

from __future__ import annotations

import platform
import tempfile
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import numpy as np

from gcode import Source
from vmach.compensation.aim.surface import SurfaceCheck
from vmach.compensation.compensate import Compensation
from vmach.compensation.figures import remarks, rows
from vmach.files.together import together
from vmach.job import Job
from vmach.machine import Variant
from vmach.report import (
    Column,
    InspectedPoints,
    RunRecord,
    build_display_mesh,
    write_report_html,
)

__all__ = ["write_compensation_report"]


def write_compensation_report(
    path: Path,
    found: Compensation,
    surface: SurfaceCheck,
    *,
    job: Job,
    model: Variant,
    command: str,
) -> None:
    """Write one HTML file: figures, lines, histogram and map of the part before and after.

    Raises
    ------
    InputError
        The file cannot be written.
    """
    from vmach.report.pictures.heatmap import draw_heatmap  # late: it loads matplotlib

    points, mesh = _inspected(surface), surface.surface.mesh
    display = build_display_mesh(mesh.vertices_mm, mesh.triangles, points)
    record = _record(found, surface, job, model, command)
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "heatmap.png"
        with together():  # it is in its place before it is read, whatever comes with the page
            draw_heatmap(picture, display, points, record)
        write_report_html(path, display, points, record, stills=[picture])


def _inspected(surface: SurfaceCheck) -> InspectedPoints:
    points, rows = surface.surface.points, surface.row
    status = np.full(len(rows), "cut")
    return InspectedPoints(
        id=points.id[rows],
        feature=points.feature[rows],
        point_mm=points.point_mm[rows],
        normal=points.normal[rows],
        line=surface.line,
        tool=surface.tool,
        move=surface.move,
        time_s=surface.time_s,
        columns=(
            Column("before", "Before compensation", surface.before_mm, status),
            Column("after", "After compensation", surface.after_mm, status),
        ),
    )


def _record(
    found: Compensation, surface: SurfaceCheck, job: Job, model: Variant, command: str
) -> RunRecord:
    return RunRecord(
        title=f"{job.program.name}, compensated",
        command=command,
        model=str(model),
        tolerance_mm=job.inspection.tolerance_mm,
        started_at=datetime.now(UTC).isoformat(timespec="seconds"),
        versions={"python": platform.python_version(), "vmach": version("vmach")},
        facts={"machine": job.machine.name} | rows(found, surface),
        warnings=tuple(remarks(found, surface)),
        program_lines=tuple(Source.read(job.program).lines),
    )
