"""The models that led to a job, and how the error fell from one to the next."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vmach.base.note import Note
from vmach.base.units import um_from_mm
from vmach.diagnosis.residuals.job_survey import survey_job, survey_part
from vmach.errors import InputError
from vmach.files.atomic import atomic_file
from vmach.files.text_file import read_text
from vmach.files.toml_file import line_of_key
from vmach.fit.survey import Survey
from vmach.history.held_out import held_out_rms_um
from vmach.job import Job, read_job

__all__ = ["Step", "draw_history", "history_of", "rms_um"]


@dataclass(frozen=True)
class Step:
    """One model in the history of a job.

    Attributes
    ----------
    job : Path
    added : tuple of str
        What this model has and the one before had not.
    rms_um : float
        Of measured minus predicted, alignment taken off, on the points that were fitted.
    check_rms_um : float or None
        On a part that nothing was fitted to.
    held_out_um : float
        On features of the same readings, each foretold from a fit without it.
    notes : tuple of Note
        What was noticed of the measurements.
    """

    job: Path
    added: tuple[str, ...]
    rms_um: float
    check_rms_um: float | None
    held_out_um: float
    notes: tuple[Note, ...] = ()


def history_of(job_path: Job | str | Path, *, check: Job | None = None) -> list[Step]:
    """The models that led to a job, the first one first, each evaluated anew.

    Parameters
    ----------
    job_path : path or Job
    check : Job, optional
        Another part of the same machine, with its measured points; its own effects do not count.

    Raises
    ------
    InputError
        A job of the history is missing, or goes round in a circle.
    """
    steps: list[Step] = []
    job = read_job(job_path)
    seen: set[Path] = set()
    while True:
        if job.path.resolve() in seen:
            raise InputError("the chain of jobs refers back to itself", file=job.path)
        seen.add(job.path.resolve())
        last = job.history[-1] if job.history else {}
        survey = survey_job(job)
        other = None if check is None else survey_part(check, job)
        steps.append(
            Step(
                job=job.path,
                added=tuple(last.get("added", ())),
                rms_um=rms_um(survey),
                check_rms_um=None if other is None else rms_um(other),
                held_out_um=held_out_rms_um(survey),
                # both read the same machine: what is said of its file is said once
                notes=tuple(dict.fromkeys((*survey.notes, *(other.notes if other else ())))),
            )
        )
        if "previous" not in last:
            return steps[::-1]
        job = read_job(_previous(job, last["previous"]))


def _previous(job: Job, name: str) -> Path:
    """The job file that the last step of a job's history names.

    Raises
    ------
    InputError
        It is not there any more.
    """
    path = job.folder / name
    if path.is_file():
        return path
    text = read_text(job.path, what="job file")
    raise InputError(
        f"[[history]] previous = '{name}': no such file",
        file=job.path,
        line=line_of_key(text, ["history", str(len(job.history) - 1), "previous"]),
        accepted="the job that this one goes on from",
        hint="put it back, or take [[history]] out: the chain then begins here",
    )


def rms_um(survey: Survey, explained_mm: np.ndarray | float = 0.0) -> float:
    """RMS of measured minus predicted minus explained, (n,) mm, free parameters fitted."""
    weight = 1.0 / survey.u_mm
    residual = survey.residual_mm - explained_mm
    solution = np.linalg.lstsq(survey.nuisance * weight[:, None], residual * weight, rcond=None)[0]
    return float(um_from_mm(np.sqrt(np.mean((residual - survey.nuisance @ solution) ** 2))))


def draw_history(steps: Sequence[Step], path: Path) -> None:
    """Draw the fall of the error, model by model, into a PNG file."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(max(5.0, 1.6 + 1.7 * len(steps)), 4.0), layout="constrained")
    axes = figure.add_subplot()
    place = np.arange(len(steps))
    rows = {"points that were fitted": [s.rms_um for s in steps]}
    checked = [s.check_rms_um for s in steps if s.check_rms_um is not None]
    if len(checked) == len(steps):
        rows["another part"] = checked
    wide = 0.8 / len(rows)
    for k, (label, values) in enumerate(rows.items()):
        bars = axes.bar(
            place + (k - 0.5 * (len(rows) - 1)) * wide, values, 0.92 * wide, label=label
        )
        axes.bar_label(bars, fmt="%.2f", fontsize=8)
    names = ["+ " + "\n+ ".join(s.added) if s.added else s.job.name for s in steps]
    axes.set_xticks(place, names)
    axes.set_axisbelow(True)
    axes.set_ylabel("RMS of measured minus predicted, µm")
    axes.legend()
    axes.grid(alpha=0.3, axis="y")
    with atomic_file(path) as temporary:
        figure.savefig(temporary, format="png", dpi=130)
