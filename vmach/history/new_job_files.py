"""Files of a new job: written together, read as they will be, and taken away if they are no job."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from vmach.effects import read_effects
from vmach.errors import InputError
from vmach.files.atomic import atomic_file
from vmach.files.together import together
from vmach.job import read_job
from vmach.machine import read_machine

__all__ = ["write_and_read"]


def write_and_read(written: Mapping[Path, str], job_path: Path, *, old: Path) -> None:
    """Write all files, and take them away where they make no job.

    Parameters
    ----------
    written : mapping of Path to str
    job_path : Path
        The new job, one of them.
    old : Path
        The job that it goes on from: there stands what is wrong.

    Raises
    ------
    InputError
        With the line of the old job, as the new one is not there any more.
    """
    with together():
        for path, text in written.items():
            with atomic_file(path) as temporary:
                temporary.write_text(text, encoding="utf-8")
    try:
        job = read_job(job_path)
        read_machine(job.machine_path)
        read_effects(job.effects, file=job.path, job=job)
    except BaseException as error:
        for path in written:
            path.unlink(missing_ok=True)
        if isinstance(error, InputError) and error.file in written:  # there is no such file
            raise _of_old(error, written, old) from None
        raise


def _of_old(error: InputError, written: Mapping[Path, str], old: Path) -> InputError:
    """The same complaint with the line of the old job that says the same, if there is one."""
    assert isinstance(error.file, Path)
    rows = written[error.file].splitlines()
    said = rows[error.line - 1].strip() if error.line and error.line <= len(rows) else ""
    there = [row.strip() for row in old.read_text(encoding="utf-8-sig").splitlines()]
    where: dict[str, Path | int] = {}
    if said and said in there:
        where = {"file": old, "line": there.index(said) + 1}
    return InputError(error.what, accepted=error.accepted, hint=error.hint, **where)  # type: ignore[arg-type]
