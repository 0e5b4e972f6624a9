"""Everything that was measured for a job, ready to be compared with its model."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from vmach.base.note import Kind, Note
from vmach.effects import Circumstances, read_effects
from vmach.errors import InputError
from vmach.fit.clocks import in_likeliest_order
from vmach.fit.survey import Survey
from vmach.instruments import measure_part, read_instruments
from vmach.job import Job, read_job
from vmach.measurements import Measurement
from vmach.path.preparation import Preparation, prepare

__all__ = ["survey_job", "survey_part"]

#: readings of a measurement that are looked at, at least, where there are twice as many: a scan has
#: hundreds of thousands, and 20,000 take a minute and 1.5 GB
_LOOKED_AT = 20_000


@threadpool_limits.wrap(limits=1, user_api="blas")
def survey_job(job_path: Job | str | Path) -> Survey:
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
        preparation = prepare(job)
        _compile_circumstances(preparation)
        found.append(measure_part(preparation, job.measured, effects=effects)[0])
    found += read_instruments(job, effects=effects)
    if not found:
        raise InputError(
            "nothing was measured",
            file=job.path,
            accepted="measured = a CSV of CMM points, or [[measurements]]",
        )
    return in_likeliest_order(Survey(job, tuple(map(_looked_at, found)), effects))


def _looked_at(measurement: Measurement) -> Measurement:
    """As many readings as can be weighed, and a note where there are more."""
    few = measurement.thinned(_LOOKED_AT)
    if few is measurement:
        return measurement
    count = len(measurement)
    many = count // _LOOKED_AT
    said = f"of {count} readings {len(few)} are looked at, one of each {many} neighbours"
    return few.noted(Note.plain(Kind.LEFT_OUT, said, count - len(few), "1", file=measurement.name))


def _compile_circumstances(preparation: Preparation) -> None:
    """Ask once for what effects ask for.

    Where kernels are new, another process is busy with those of the engine, and this one would
    wait for it.
    """
    node = preparation.path.nodes[:1]
    path = Circumstances(replace(node, normal=np.eye(3)[:1]), preparation.job)
    path.warmth_of_spindle(1.0, 1.0)
    _ = path.radial_depth_mm, path.play_side


def survey_part(other: Job, model: Job) -> Survey:
    """The measured part of another job, with the machine and the effects of `model`.

    Raises
    ------
    InputError, gcode.ProgramError
        Anything wrong with the files; or the other job has no measured points.
    """
    if other.measured is None:
        raise InputError(
            "no part was measured", file=other.path, accepted="measured = a CSV of CMM points"
        )
    job = replace(
        other,
        machine=model.machine,
        effects=model.effects,
        fitted=model.fitted,
        correlated=model.correlated,
    )
    effects = read_effects(model.effects, file=model.path, job=job)
    part, _ = measure_part(prepare(job), other.measured, effects=effects)
    return Survey(job, (_looked_at(part),), effects)
