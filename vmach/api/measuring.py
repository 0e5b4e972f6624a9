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

    Examples
    --------
    >>> import vmach
    >>> found = vmach.diagnose("samples/missing_effect")
    >>> found.verdict, [finding.label for finding in found.findings]
    ('named', ['backlash Y'])
    """
    return diagnose_survey(survey_job(job))


def add(
    job: str | Path, effects: str | Sequence[str], *, out: str | Path | None = None
) -> tuple[Job, tuple[NamedEffect, ...]]:
    """Fit effects to a job's measurements and write a new job file that holds them.

    Parameters
    ----------
    job : path
    effects : str or sequence of str
        ``NAME`` or ``NAME:TARGET``, such as ``backlash:X``.
    out : path, optional
        The job file to write; a new name beside the old one where left out.

    Returns
    -------
    the new job, and the effects with their parameters: first those that the same readings gave
    before, fitted anew

    Raises
    ------
    InputError
        Unknown effect or target, an effect that the job has already, a file that is there already.

    Examples
    --------
    >>> import vmach
    >>> job, (lost,) = vmach.add("samples/missing_effect", "backlash:Y", out="lost-motion.toml")
    >>> round(lost.parameters["reversal_um"], 1)
    7.0
    """
    target = None if out is None else Path(out)
    named = [effects] if isinstance(effects, str) else list(effects)
    path, found = add_effects(job, named, out=target)
    return read_job(path), found
