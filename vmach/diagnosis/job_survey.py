"""Everything that was measured for a job, ready to be compared with its model."""

from __future__ import annotations

from pathlib import Path

from vmach.effects import read_effects
from vmach.errors import InputError
from vmach.fit.survey import Survey
from vmach.job import Job, read_job
from vmach.measurements import Measurement, measure_part, read_instruments
from vmach.preparation import prepare

__all__ = ["survey_job", "survey_part"]


def survey_job(job_path: str | Path) -> Survey:
    """The measured part and all instruments of a job, with the job's own effects in the model.

    Raises
    ------
    InputError, gcode.ProgramError
        Anything wrong with the files; or the job has no measurement.
    """
    job = read_job(job_path)
    effects = read_effects(job.effects, file=job.path, job=job)
    found: list[Measurement] = []
    if job.measured is not None:
        found.append(measure_part(prepare(job), job.measured, effects=effects)[0])
    found += read_instruments(job, effects=effects)
    if not found:
        raise InputError(
            "nothing was measured",
            file=job.path,
            accepted="measured = a CSV of CMM points, or [[measurements]]",
        )
    return Survey(job, tuple(found))


def survey_part(job: Job, program: Path, points: Path) -> Survey:
    """Another part that the job's machine made, by another program and its measured points."""
    effects = read_effects(job.effects, file=job.path, job=job)
    part, _ = measure_part(prepare(job, program_path=program), points, effects=effects)
    return Survey(job, (part,))
