"""The files of a run: summary, deviations, solid, picture and report."""

from __future__ import annotations

import hashlib
import io
import platform
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import TextIO

import numpy as np

from stock import write_part
from vmach.base.stage_clock import Progress, StageClock, silent
from vmach.base.units import um_from_mm
from vmach.files.atomic import atomic_file, atomic_folder
from vmach.files.csv_table import Cells, fixed, whole, words, write_csv
from vmach.job import Job, job_name
from vmach.nominal.points import SurfacePoints
from vmach.prediction import Prediction
from vmach.prediction.error_budget import write_budget_csv
from vmach.report import (
    STATUSES,
    InputFile,
    RunRecord,
    part_colours,
    summary,
    write_deviations_csv,
    write_features_file,
    write_report_html,
    write_summary,
)
from vmach.run.inspection import remainder_mm
from vmach.run.part_pictures import HEATMAP_FILE, REMAINDER_FILE, PartPictures, display_mesh
from vmach.run.pipeline import MachinedPart
from vmach.uncertainty.first_order import prediction_u_mm

__all__ = [
    "ALL_FILES",
    "FEATURES_FILE",
    "REMAINDER_FILE",
    "RESULT_FILES",
    "SOLID_FILE",
    "default_folder",
    "input_files",
    "prediction_columns",
    "prediction_summary",
    "run_record",
    "versions",
    "write_coloured_part",
    "write_columns",
    "write_results",
]

#: the virtual part, where it was cut
SOLID_FILE = "part.stl"
#: values of the drawing's requirements, where the job has any
FEATURES_FILE = "features.csv"
#: what a run leaves in its folder
RESULT_FILES = (
    "report.html",
    HEATMAP_FILE,
    "summary.json",
    "deviations.csv",
    "budget.csv",
    SOLID_FILE,
)
#: and what it may leave there
ALL_FILES = (*RESULT_FILES, REMAINDER_FILE, FEATURES_FILE)

_PACKAGES = ("vmach", "numpy", "scipy", "numba", "manifold3d", "trimesh", "pyvista")


def write_results(
    made: MachinedPart, out_dir: Path, *, command: str, pictures: PartPictures | None = None,
    progress: Progress = silent,
) -> dict:  # fmt: skip
    """Write all files of a run into a folder, all of them or none.

    Parameters
    ----------
    made : MachinedPart
    out_dir : Path
    command : str
        Command line as typed.
    pictures : PartPictures, optional
        What was drawn of the part on the way.
    progress : Progress

    Returns
    -------
    dict
        The summary, as in ``summary.json``.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    clock, pictures = StageClock(progress), pictures or PartPictures()
    with atomic_folder(out_dir, replaced=ALL_FILES) as folder, clock.stage("write"):
        if made.part is not None:
            write_part(made.part, folder / SOLID_FILE)
        write_deviations_csv(folder / "deviations.csv", made.points)
        cut = made.points.primary.is_cut
        write_budget_csv(folder / "budget.csv", made.points.id[cut], made.states, made.budget)
        record = run_record(made, command)
        if made.features:
            write_features_file(folder / FEATURES_FILE, record)
        pictures.draw(made)
        stills = pictures.write_stills(folder)
        write_report_html(folder / "report.html", pictures.mesh, made.points, record, stills=stills)
        write_summary(folder / "summary.json", made.points, record)
    return summary(made.points, record)


def write_picture(path: Path, made: MachinedPart, record: RunRecord) -> None:
    """Draw the map of deviations alone, with the flags of the drawing."""
    from vmach.report.pictures.heatmap import draw_heatmap  # late: it loads matplotlib

    primary = made.points.primary.name
    draw_heatmap(path, display_mesh(made), made.points, record, columns=[primary])


def write_coloured_part(made: MachinedPart, path: Path) -> None:
    """Write the virtual part coloured by deviation: ``.glb``, ``.3mf`` or (grey) ``.stl``.

    Raises
    ------
    stock.StockError
        Unknown ending.
    """
    part = made.part
    colours = part_colours(part.vertices_mm, part.triangles, made.points)
    with atomic_file(path) as temporary:
        write_part(part, temporary, colours=colours)


def run_record(made: MachinedPart, command: str) -> RunRecord:
    """What was run: files with hashes, versions, facts."""
    job, program = made.job, made.preparation.program
    moves = program.moves
    minutes = float(moves.start_s[-1] + moves.duration_s[-1]) / 60 if len(moves) else 0.0
    return RunRecord(
        title=job_name(job.path),
        command=command,
        model=str(made.model),
        tolerance_mm=job.inspection.tolerance_mm,
        started_at=datetime.now(UTC).isoformat(timespec="seconds"),
        files=input_files(job),
        versions=versions(),
        stages_s=made.stages_s,
        facts={
            "machine": job.machine.name,
            "chain": str(job.machine.chain),
            "moves": f"{len(moves)}",
            "machining time": f"{minutes:.1f} min",
            **({"volume of the part": f"{made.part.volume_mm3:.1f} mm3"} if made.part else {}),
            "effects": ", ".join(job.effects) or "none beside the error tables",
        },
        warnings=tuple(map(str, made.notes)),
        notes=tuple(made.notes),
        program_lines=tuple(program.source.lines),
        comparison=made.comparison,
        points_file="deviations.csv",
        features=made.features,
        circular_tests=made.circular_tests,
        part=job.drawing.part,
        serial=job.drawing.serial,
        revision=job.drawing.revision,
    )


def input_files(job: Job) -> tuple[InputFile, ...]:
    """All files of a job, with their hashes."""
    return tuple(_input_file(role, path, job.folder) for role, path in job.files())


def versions() -> dict[str, str]:
    """Of Python, vmach and what it calculates with."""
    return {"python": platform.python_version()} | {p: version(p) for p in _PACKAGES}


def _input_file(role: str, path: Path, folder: Path) -> InputFile:
    content = path.read_bytes()
    name = path.relative_to(folder) if path.is_relative_to(folder) else path
    return InputFile(role, str(name), hashlib.sha256(content).hexdigest(), len(content))


def default_folder(job_path: Path) -> Path:
    """Where results go when the user names no folder: ``vmach-results/NAME`` right here."""
    return Path("vmach-results") / job_name(Path(job_path))


def prediction_columns(points: SurfacePoints, prediction: Prediction) -> dict[str, Cells]:
    """Columns of a prediction's table, a row a point; empty where no tool made the surface."""
    cut, states = prediction.is_cut, prediction.states

    def spread(values: np.ndarray) -> np.ndarray:
        full = np.zeros(len(points), values.dtype)
        full[cut] = values
        return full

    return {
        "id": words(points.id),
        "deviation_um": fixed(um_from_mm(prediction.deviation_mm), 6, shown=cut),
        "u_um": fixed(spread(um_from_mm(prediction_u_mm(prediction))), 4, shown=cut),
        "line": whole(spread(states.line), shown=cut),
        "tool": whole(spread(states.tool), shown=cut),
        "time_s": fixed(spread(states.time_s), 3, shown=cut),
        "status": words(STATUSES, prediction.edges.status),
    }


def write_columns(file: TextIO, columns: dict[str, Cells]) -> None:
    """Write a table to an open text file, such as the terminal."""
    text = io.BytesIO()
    write_csv(text, columns)
    file.write(text.getvalue().decode())


def prediction_summary(points: SurfacePoints, prediction: Prediction) -> dict:
    """Figures of a prediction; measured against predicted where the points were measured."""
    cut = prediction.is_cut
    deviation_um = um_from_mm(prediction.deviation_mm[cut])
    found = {
        "points": len(points),
        "model": str(prediction.variant),
        "status": {
            name: int((prediction.edges.status == k).sum()) for k, name in enumerate(STATUSES)
        },
    }
    if cut.any():
        found |= {
            "mean_um": float(deviation_um.mean()),
            "rms_um": float(np.sqrt(np.mean(deviation_um**2))),
            "min_um": float(deviation_um.min()),
            "max_um": float(deviation_um.max()),
        }
    remainder = remainder_mm(points, prediction)
    if remainder is not None:
        rms_mm = float(np.sqrt(np.mean(remainder[cut] ** 2)))
        found["measured_minus_predicted_rms_um"] = um_from_mm(rms_mm)
    return found
