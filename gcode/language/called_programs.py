"""Programs that a program calls: in sections of its own file, or in files beside it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from gcode.errors import ProgramError
from gcode.text.source import Source

__all__ = ["Routine", "find_beside", "unknown_calls"]

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
    folders: Sequence[Path], names: Sequence[str], *, endings: Sequence[str] = ("",)
) -> Routine | None:
    """The first file of folders that has one of the names, whatever the case of its letters.

    Parameters
    ----------
    folders : sequence of Path
        See `gcode.language.options.RunOptions.folders`.
    names : sequence of str
        Without folders: a name with one is never found.
    endings : sequence of str
        Put behind each name, as ``.nc``.
    """
    wanted = [f"{n}{end}".lower() for n in names for end in endings if _NAME.fullmatch(n)]
    for folder in folders if wanted else ():
        there = {p.name.lower(): p for p in sorted(folder.iterdir())} if folder.is_dir() else {}
        for name in wanted:
            path = there.get(name)
            if path is not None and path.is_file() and path.stat().st_size < _LARGEST_BYTES:
                lines = Source.read(path).lines
                return Routine(lines, 0, len(lines), path)
    return None


def unknown_calls(names: Iterable[str], files: Iterable[str]) -> ProgramError:
    """One error for all calls of a program that lead nowhere.

    Parameters
    ----------
    names : iterable of str
        As the job's ``ignore_calls`` takes them.
    files : iterable of str
        Names of the files that would hold them.
    """
    names, files = list(dict.fromkeys(names)), list(dict.fromkeys(files))
    listed = ", ".join(f"'{name}'" for name in names)
    where = f"{', '.join(files)} beside the program or in subprograms = '...'" if files else ""
    return ProgramError(
        f"what it calls is neither in this file nor beside it: {', '.join(names)}",
        accepted=f"ignore_calls = [{listed}] in [control], if they move nothing"
        + (f"; {where}" if where else ""),
    )
