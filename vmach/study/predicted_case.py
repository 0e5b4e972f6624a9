"""What a study does that names no function: the part's points, predicted for every case."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from vmach.base.units import um_from_mm
from vmach.base.variant import Variant
from vmach.effects import read_effects
from vmach.errors import InputError
from vmach.features.evaluation import Drawing, evaluate
from vmach.features.feature import Points
from vmach.job import Job, read_job
from vmach.machine.variant_name import variant_called
from vmach.nominal import read_nominal
from vmach.nominal.points import SurfacePoints, read_points_csv
from vmach.path.preparation import Preparation, prepare
from vmach.plausibility import admitted_machine
from vmach.prediction import predict_surface
from vmach.report.result import STATUSES
from vmach.run.drawing import drawing_error, job_drawing
from vmach.run.inspection import surface_points
from vmach.study.case import Case, Value
from vmach.uncertainty.drawn_machine import DrawnTables, drawn_steps
from vmach.uncertainty.tables import TableUncertainty

__all__ = ["predicted_case"]

#: what the values of a case may be called
_NAMES = ("job", "points", "drawing", "machine", "program", "model", "draw")
#: those that name a file
_FILES = ("job", "points", "machine", "program")
#: programs and tables of points that a worker keeps at hand
_KEPT = 8


def predicted_case(case: Case, random: np.random.Generator) -> dict[str, Any]:
    """Deviations of the points, um; None where no tool made the surface.

    Values: ``job`` and ``points``; ``machine`` and ``program`` in place of the job's; ``model``;
    ``draw``, a number: the machine then has the corrections that belong to this case. ``drawing``:
    what the job's drawing asks for is evaluated, on `points`, or without them on points of the CAD.
    """
    values = case.values
    with_drawing = values.get("drawing", False) is True
    for name in ("job",) if with_drawing else ("job", "points"):
        if name not in values:
            raise InputError(f"a case without '{name}'", accepted=", ".join(_NAMES))
    program = case.file("program") if "program" in values else None
    machine = case.file("machine") if "machine" in values else None
    preparation = _preparation(case.file("job"), program, machine)
    job = preparation.job
    file = case.file("points") if "points" in values else None
    drawing: Drawing | None = None
    if with_drawing:
        points, drawing = _drawing(case.file("job"), file)
    else:
        points = _points(case.file("points"))
    variant = variant_called(values.get("model", Variant.ABBE))
    effects = list(read_effects(job.effects, file=job.path, job=job))
    if "draw" in values and variant is not Variant.NONE:
        steps = drawn_steps(effects, case.entropy)
        effects = [e.with_drawn(d) for e, d in zip(effects, steps, strict=True)]
        tables = TableUncertainty.of(job.machine)
        effects.append(DrawnTables(job.machine, variant, tables, case.entropy))
    found = predict_surface(preparation, points, variant, effects)
    deviation = um_from_mm(found.deviation_mm)
    cut = deviation[found.is_cut]
    result: dict[str, Any] = {
        "status": {s: int((found.edges.status == k).sum()) for k, s in enumerate(STATUSES)},
        "mean_um": float(cut.mean()) if len(cut) else None,
        "rms_um": float(np.sqrt(np.mean(cut**2))) if len(cut) else None,
        "range_um": float(np.ptp(cut)) if len(cut) else None,
    }  # fmt: skip
    if file is not None:
        result["deviation_um"] = {
            str(name): float(d) if is_cut else None
            for name, d, is_cut in zip(points.id, deviation, found.is_cut, strict=True)
        }
    if drawing is not None:
        is_cut = found.is_cut
        shown = np.where(is_cut, found.deviation_mm, 0.0)
        part = Points(points.point_mm, points.normal, shown, is_cut)
        result["value_mm"] = _values_mm(job, drawing, part)
    return result


def _values_mm(job: Job, drawing: Drawing, part: Points) -> dict[str, dict[str, float | None]]:
    """Values by feature and callout, mm; None of a feature that no tool made."""
    found: dict[str, dict[str, float | None]] = {}
    for asked in drawing.requirements:
        if asked.refused:
            continue
        own = found.setdefault(asked.feature, {})
        rows = np.concatenate([m.rows for m in drawing.feature(asked.feature).members])
        if not part.is_known[rows].any():
            own[asked.callout.text] = None
            continue
        try:
            measures = evaluate(drawing, asked, part)
        except InputError as error:
            if asked.source:  # of the CAD: the rest is evaluated
                continue
            said = f"tolerance {asked.callout.text!r} of {asked.feature!r}"
            raise drawing_error(job, error, "tolerances", asked.feature, said) from None
        for measure in measures:
            label = f", {measure.label}" if measure.label else ""
            own[f"{asked.callout.text}{label}"] = float(measure.value_mm)
    return found


def _check_values(
    values: Mapping[str, Sequence[Value]],
    folder: Path,
    fail: Callable[[str, str, str], InputError],
) -> None:
    """Refuse what every case with a value would fail by, before any is worked on.

    Parameters
    ----------
    values : mapping of name to sequence of Value
        Those of all cases.
    folder : Path
        From which names of files count.
    fail : callable
        The error for a name, what is wrong and what is accepted.
    """
    for name in values:
        if name not in _NAMES:
            raise fail(name, f"cases have no value '{name}'", ", ".join(_NAMES))
    for value in values.get("drawing", ()):
        if not isinstance(value, bool):
            accepted = "true or false, without quotes, in [cases]: a cell of a table is text"
            raise fail("drawing", f"drawing = {value!r}", accepted)
    for name in ("job", "points"):
        if name not in values and (name == "job" or set(values.get("drawing", ())) != {True}):
            raise fail(name, f"the cases have no '{name}'", "the name of a file")
    for name in _FILES:
        for value in values.get(name, ()):
            if not isinstance(value, str) or not _is_there(folder / value, name):
                raise fail(name, f"{name} = {value!r}: no such file", "the name of a file")
    for value in values.get("draw", ()):
        if isinstance(value, bool) or not isinstance(value, int) or value < 1:
            raise fail("draw", f"draw = {value!r}", "a whole number from 1")
    for value in values.get("model", ()):
        if value not in list(Variant):
            raise fail("model", f"model = {value!r}", ", ".join(Variant))


def _is_there(path: Path, name: str) -> bool:
    return path.is_file() or (name == "job" and (path / "job.toml").is_file())


predicted_case.check_values = _check_values  # type: ignore[attr-defined]


@lru_cache(_KEPT)
def _preparation(job: Path, program: Path | None, machine: Path | None) -> Preparation:
    read = read_job(job)
    if machine is not None:
        read = replace(read, machine=admitted_machine(machine), machine_path=machine)
    return prepare(read, program_path=program)


@lru_cache(_KEPT)
def _drawing(job: Path, file: Path | None) -> tuple[SurfacePoints, Drawing]:
    """Points, and what the job's drawing asks for on them."""
    read = read_job(job)
    nominal = read_nominal(read.nominal, read.nominal_unit) if read.nominal else None
    points = _points(file) if file else surface_points(read, nominal)
    found = job_drawing(read, nominal, points)
    if found is None:
        raise InputError(
            "the job asks for no feature", file=read.path,
            accepted='[tolerances], as bore = "35 H7", or tolerances in the STEP file',
            hint="drawing = false leaves the drawing out",
        )  # fmt: skip
    return points, found


@lru_cache(_KEPT)
def _points(path: Path) -> SurfacePoints:
    return read_points_csv(path)
