"""Endings of files to write: a name may not promise what the file is not."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from vmach.errors import InputError

__all__ = ["check_ending"]


def check_ending(
    path: Path | None, accepted: Collection[str], *, what: str, is_needed: bool = False
) -> None:
    """Refuse a name whose ending is that of another kind of file; asked before the work begins.

    Parameters
    ----------
    path : Path or None
        None where no such file was asked for.
    accepted : collection of str
        Endings in lower case, each with its point.
    what : str
        What is written, with its article.
    is_needed : bool
        The ending decides what is written: a name without one is refused too.

    Raises
    ------
    InputError
    """
    if path is None or path.suffix.lower() in accepted or not (path.suffix or is_needed):
        return
    said = f"the ending {path.suffix!r}" if path.suffix else "a name without an ending"
    raise InputError(f"{said} for {what}", file=path, accepted=", ".join(accepted))
