"""The one-file report of what is on the screen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np

from vmach.errors import InputError
from vmach.job import job_name
from vmach.report import Column, InspectedPoints, ReportView, RunRecord, write_report_html
from vmach.report.result import Colouring
from vmach.run.results import input_files, versions
from vmach.workbench.model.part_model import PartModel
from vmach.workbench.model.point_set import PointSet

__all__ = ["Shown", "less_of_other", "sliders_in_words", "write_screen_report"]


@dataclass(frozen=True)
class Shown:
    """What is on the screen.

    Attributes
    ----------
    points : PointSet
        C points.
    value_mm : (C,) float64
        NaN where nothing is shown.
    label : str
        What the values are.
    facts : mapping of str to str
        What else the reader has to know: error model, sliders.
    tolerance_mm : float
    is_signed : bool
        Whether the values have a direction; else they are sizes.
    """

    points: PointSet
    value_mm: np.ndarray
    label: str
    facts: Mapping[str, str]
    tolerance_mm: float
    is_signed: bool = True


def write_screen_report(
    path: Path, model: PartModel, shown: Shown, view: ReportView, *, picture: Path | None
) -> None:
    """Write the report of what is shown, as it is seen.

    Parameters
    ----------
    path : Path
    model : PartModel
    shown : Shown
    view : ReportView
    picture : Path or None
        Of the screen, for print and for browsers without WebGL 2.
    """
    points, name = shown.points, "shown"
    states, is_known = points.states, np.isfinite(shown.value_mm)
    status = np.where(is_known, "cut", "uncut")
    inspected = InspectedPoints(
        id=points.id, feature=points.feature, point_mm=points.point_mm, normal=points.normal,
        line=states.line, tool=states.tool, move=states.move, time_s=states.time_s,
        columns=(
            Column(name, shown.label, shown.value_mm, status, weight=points.weight,
                   is_signed=shown.is_signed),
        ),
        u_mm=points.u_mm,
    )  # fmt: skip
    onto = points.on_mesh(model.mesh)
    value = onto.at_vertices(shown.value_mm)
    is_known = onto.known & np.isfinite(value)
    mesh = replace(
        model.mesh, colourings={name: Colouring(np.where(is_known, value, 0.0), is_known)}
    )
    stills = [] if picture is None else [picture]
    write_report_html(path, mesh, inspected, _record(model, shown), stills=stills, view=view)


def _record(model: PartModel, shown: Shown) -> RunRecord:
    job = model.job
    moves = model.preparation.program.moves
    facts = {
        **shown.facts,
        "machine": job.machine.name,
        "chain": str(job.machine.chain),
        "moves": str(len(moves)),
        "effects": ", ".join(effect.label for effect in model.effects) or "none",
    }
    return RunRecord(
        title=job_name(job.path),
        command=f"vmach open {job.path.name}",
        model=shown.facts.get("error model", "abbe"),
        tolerance_mm=shown.tolerance_mm,
        started_at=datetime.now(UTC).isoformat(timespec="seconds"),
        files=input_files(job),
        versions=versions(),
        facts=facts,
        warnings=tuple(map(str, model.notes)),
        notes=model.notes,
        program_lines=tuple(model.preparation.program.source.lines),
    )


def less_of_other(
    points: PointSet, value_mm: np.ndarray, other: Mapping[str, Any], values: bytes
) -> np.ndarray:
    """What another job has at the same points taken off, (C,) mm; NaN where it has none.

    Parameters
    ----------
    points : PointSet
        C points.
    value_mm : (C,) float64
    other : mapping
        ``name`` of the other job, and ``ids`` of its points.
    values : bytes
        float64 mm at those points.

    Raises
    ------
    InputError
        The two have no point in common.
    """
    theirs = dict(zip(other["ids"], np.frombuffer(values, "<f8").tolist(), strict=True))
    taken = np.array([theirs.get(name, np.nan) for name in points.id.tolist()])
    if not np.isfinite(taken).any():
        raise InputError(f"{other['name']} has no point in common with this job",
                         accepted="two jobs of one part")  # fmt: skip
    return value_mm - taken


def sliders_in_words(changes: Sequence[Mapping[str, Any]]) -> str:
    """What the sliders say, for a reader."""
    rows = []
    for one in changes:
        if "component" in one:
            rows.append(f"machine data of {one['component']}")
            continue
        sizes = ", ".join(f"{key} {float(v):.4g}" for key, v in one.get("parameters", {}).items())
        rows.append(f"{one.get('effect')} {one.get('target') or ''}: {sizes}".replace(" :", ":"))
    return "; ".join(rows) or "none moved"
