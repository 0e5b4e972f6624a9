"""The files of a diagnosis: figures, page, and the program of the next measurement."""

from __future__ import annotations

from pathlib import Path

from vmach.atomic import atomic_folder
from vmach.diagnosis.findings import Diagnosis
from vmach.diagnosis.page import write_diagnosis_page
from vmach.diagnosis.report import write_figures
from vmach.job import job_name

__all__ = ["FOLDER_FILES", "write_diagnosis"]

_FIGURES, _PAGE, _PROGRAM = FOLDER_FILES = ("diagnosis.json", "diagnosis.html", "next.nc")


def write_diagnosis(folder: Path, found: Diagnosis, *, command: str) -> tuple[str, ...]:
    """Write all files of a diagnosis into a folder, all of them or none; returns their names.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    program = None if found.next_measurement is None else _PROGRAM
    title = job_name(found.residuals.survey.job.path)
    with atomic_folder(folder) as place:
        write_figures(place / _FIGURES, found, program=program)
        write_diagnosis_page(place / _PAGE, found, title=title, command=command, program=program)
        if found.next_measurement is not None:
            (place / _PROGRAM).write_text(found.next_measurement.program, encoding="utf-8")
    return tuple(filter(None, (_FIGURES, _PAGE, program)))
