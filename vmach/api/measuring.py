"""Comparing with measurements: what the model lacks, and what is added to it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from vmach.diagnosis.diagnose import Diagnosis
from vmach.diagnosis.diagnose import diagnose as diagnose_survey
from vmach.diagnosis.named_fit import NamedEffect
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.history.added_effects import add_effects
from vmach.job import Job, read_job

__all__ = ["add", "diagnose"]


def diagnose(job: Job | str | Path) -> Diagnosis:
    """Compare a job's measurements with the model and say what is missing.

    Parameters
    ----------
    job : Job or path
        With measured points, or instruments, or both.

    Raises
    ------
    InputError, gcode.ProgramError
        Anything wrong with the files; or nothing was measured.
    """
    return diagnose_survey(survey_job(job))


def add(
    job: str | Path, effects: Sequence[str], *, out: str | Path | None = None
) -> tuple[Job, tuple[NamedEffect, ...]]:
    """Fit effects to a job's measurements and write a new job file that holds them.

    Parameters
    ----------
    job : path
    effects : sequence of str
        ``NAME`` or ``NAME:TARGET``, such as ``backlash:X``.
    out : path, optional
        The job file to write; a new name beside the old one where left out.

    Returns
    -------
    the new job, and the effects with their parameters

    Raises
    ------
    InputError
        Unknown effect or target, an effect that the job has already, a file that is there already.
    """
    target = None if out is None else Path(out)
    path, found = add_effects(job, list(effects), out=target)
    return read_job(path), found
