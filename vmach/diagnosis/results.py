"""The files of a diagnosis: figures, page, and the program of the next measurement."""

from __future__ import annotations

from pathlib import Path

from threadpoolctl import threadpool_limits

from vmach.diagnosis.diagnose import Diagnosis
from vmach.diagnosis.report import write_figures
from vmach.files.atomic import atomic_folder
from vmach.job import Job, job_name
from vmach.nominal import Mesh, read_nominal

__all__ = ["FOLDER_FILES", "read_nominal_mesh", "write_diagnosis"]

_FIGURES, _PAGE, _PROGRAM = FOLDER_FILES = ("diagnosis.json", "diagnosis.html", "next.nc")


def read_nominal_mesh(job: Job) -> Mesh | None:
    """The surface that the residual is shown on; None where the job has no nominal CAD.

    Raises
    ------
    InputError
        It cannot be read.
    """
    return None if job.nominal is None else read_nominal(job.nominal, job.nominal_unit).mesh


@threadpool_limits.wrap(limits=1, user_api="blas")
def write_diagnosis(
    folder: Path,
    found: Diagnosis,
    *,
    nominal: Mesh | None = None,
    command: str,
    job: str = "JOB",
) -> tuple[str, ...]:
    """Write all files of a diagnosis into a folder, all of them or none; returns their names.

    Parameters
    ----------
    folder : Path
    found : Diagnosis
    nominal : Mesh, optional
        The surface to show the residual on; without it the measured points are shown alone.
    command : str
        Command line as typed.
    job : str
        The job as typed, for the commands that the page proposes.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    # late: a diagnosis without a page does not wait for what draws it
    from vmach.diagnosis.page import write_diagnosis_page

    program = None if found.next_program is None else _PROGRAM
    title = job_name(found.residuals.survey.job.path)
    with atomic_folder(folder) as place:
        write_figures(place / _FIGURES, found, program=program)
        write_diagnosis_page(
            place / _PAGE,
            found,
            title=title,
            nominal=nominal,
            command=command,
            job=job,
            program=program,
        )
        if found.next_program is not None:
            (place / _PROGRAM).write_text(found.next_program, encoding="utf-8")
    return tuple(filter(None, (_FIGURES, _PAGE, program)))
