"""Errors that a user can cause and mend; each carries one complete message."""

from __future__ import annotations

from pathlib import Path

from vmach.base.note import Note

__all__ = ["InputError", "VmachError"]


class VmachError(Exception):
    """Base of all errors that this package raises on purpose."""


class InputError(VmachError, ValueError):
    """Something in the user's files or arguments is wrong.

    Parameters
    ----------
    what : str
        What is wrong, with the value and its unit.
    file : path, optional
        The file at fault.
    line : int, optional
        1-based line in `file`.
    accepted : str, optional
        What would be accepted.
    hint : str, optional
        What to do about it.
    note : Note, optional
        The same as a record, where a check of the input made one.

    Examples
    --------
    >>> import vmach
    >>> try:
    ...     vmach.read_job("nowhere/job.toml")
    ... except vmach.InputError as error:
    ...     print(error.file, error.what, sep=": ")
    nowhere/job.toml: job file not found
    """

    def __init__(
        self,
        what: str,
        *,
        file: str | Path | None = None,
        line: int | None = None,
        accepted: str | None = None,
        hint: str | None = None,
        note: Note | None = None,
    ) -> None:
        self.what, self.file, self.line = what, file, line
        self.accepted, self.hint, self.note = accepted, hint, note
        where = "" if file is None else f"{file}: " if line is None else f"{file}:{line}: "
        text = where + what
        if accepted:
            text += f"; accepted: {accepted}"
        if hint:
            text += f" (hint: {hint})"
        super().__init__(text)
