"""Files of a new job: written together, read as they will be, and taken away if they are no job.

Nothing has their names: of two commands that write new jobs at once, each gets names of its own.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path

from vmach.effects import read_effects
from vmach.errors import InputError
from vmach.files.atomic import NameTakenError, atomic_file
from vmach.files.together import together
from vmach.job import free_job_name, read_job
from vmach.machine import read_machine

__all__ = ["check_free", "write_new_job"]


def check_free(out: Path | None) -> None:
    """Refuse a name that was told for a new job, where something has it.

    Raises
    ------
    InputError
    """
    if out is not None and os.path.lexists(out):
        raise InputError("file is there already", file=out, hint="choose another name with -o")


def write_new_job(
    old: Path, texts: Callable[[Path], Mapping[Path, str]], *, out: Path | None
) -> tuple[Path, ...]:
    """Write a job that goes on from another, under names that nothing has.

    Parameters
    ----------
    old : Path
        The job that it goes on from.
    texts : callable
        Gives the files of the new job from its path, the job first. Asked again where another
        command has taken a name in the meantime.
    out : Path or None
        The job file to write; a new name beside the old one where None.

    Returns
    -------
    tuple of Path
        What was written, as in `texts`.

    Raises
    ------
    InputError
        A file is there already, or the files make no job.
    """
    while True:
        check_free(out)
        target = out or free_job_name(old)
        with suppress(NameTakenError):
            written = texts(target)
            _write_and_read(written, target, old=old)
            return tuple(written)


def _write_and_read(written: Mapping[Path, str], job_path: Path, *, old: Path) -> None:
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
            with atomic_file(path, is_new=True) as temporary:
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
