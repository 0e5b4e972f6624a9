"""Programs that a program calls: in sections of its own file, or in files beside it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from gcode.text.regular_file import read_regular_file

__all__ = ["Routine", "find_beside"]

#: larger ones are no subprograms
_LARGEST_BYTES = 50_000_000
_NAME = re.compile(r"[\w.$-]+")


@dataclass(frozen=True)
class Routine:
    """Lines that are run: a program, or a part of its file.

    Attributes
    ----------
    lines : sequence of str
    start, stop : int
        Those of `lines` that are its own.
    file : Path or None
        Where they are from, if not from the program's own file.
    """

    lines: Sequence[str] = field(repr=False)
    start: int
    stop: int
    file: Path | None = None


def find_beside(
    folder: Path | None, names: Sequence[str], *, endings: Sequence[str] = ("",)
) -> Routine | None:
    """The first file of a folder that has one of the names, whatever the case of its letters.

    Parameters
    ----------
    folder : Path or None
        Of the calling program; None for a text without a file.
    names : sequence of str
        Without folders: a name with one is never found.
    endings : sequence of str
        Put behind each name, as ``.nc``.
    """
    wanted = [f"{n}{end}".lower() for n in names for end in endings if _NAME.fullmatch(n)]
    if folder is None or not wanted or not folder.is_dir():
        return None
    there = {path.name.lower(): path for path in sorted(folder.iterdir())}
    for name in wanted:
        path = there.get(name)
        if path is not None and path.is_file() and path.stat().st_size < _LARGEST_BYTES:
            lines = read_regular_file(path).decode("latin-1").splitlines()
            return Routine(lines, 0, len(lines), path)
    return None
