"""All dialects: those in the folder `gcode.dialects`, and those that other packages bring.

A package brings one by an entry point of the group ``vmach.dialects`` that names its class.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib.metadata import entry_points
from pathlib import Path

from gcode.errors import ProgramError
from gcode.language.check import check_dialect
from gcode.language.dialect import Dialect

__all__ = ["ENTRY_POINTS", "Recognition", "choose_dialect", "dialect_called", "dialect_name",
           "dialect_names", "dialect_of", "load_dialects"]  # fmt: skip

ENTRY_POINTS = "vmach.dialects"
#: has the programs that no other dialect recognises
_FALLBACK = "linuxcnc"
#: Only so much of a program is searched at first, bytes.
_HEAD = 30_000


def _in_folder() -> Iterator[type[Dialect]]:
    """Dialects that the modules of the folder name in ``__all__``."""
    package = importlib.import_module("gcode.dialects")
    for module in sorted(m.name for m in pkgutil.iter_modules(package.__path__)):
        found = importlib.import_module(f"gcode.dialects.{module}")
        for name in getattr(found, "__all__", ()):
            kind = getattr(found, name)
            if isinstance(kind, type) and issubclass(kind, Dialect):
                yield kind


def _of_packages() -> Iterator[type[Dialect]]:
    for point in sorted(entry_points(group=ENTRY_POINTS), key=lambda p: p.name):
        try:
            yield point.load()
        except Exception as error:
            whose = None if point.dist is None else f"it belongs to the package {point.dist.name}"
            raise ProgramError(
                f"entry point '{point.name} = {point.value}' of {ENTRY_POINTS} cannot be loaded: "
                f"{error!r}",
                accepted="MODULE:CLASS of a subclass of gcode.Dialect",
                hint=whose,
            ) from error


def load_dialects(*more: type[Dialect]) -> dict[str, type[Dialect]]:
    """Find and check all dialects.

    Parameters
    ----------
    *more : type
        Further ones.

    Returns
    -------
    dict
        Name and synonyms -> dialect, in the order in which their marks are looked for.

    Raises
    ------
    ProgramError
        A dialect lacks something, has something unknown, or takes the name of another; with its
        file and line.
    """
    found: dict[str, type[Dialect]] = {}
    for kind in sorted((*_in_folder(), *_of_packages(), *more), key=lambda k: (k.rank, k.name)):
        check_dialect(kind, found)
        found |= dict.fromkeys((kind.name, *kind.synonyms), kind)
    return found


@cache
def _dialects() -> dict[str, type[Dialect]]:
    return load_dialects()


def dialect_names() -> tuple[str, ...]:
    """Names of all dialects."""
    return tuple(sorted({kind.name for kind in _dialects().values()}))


def dialect_called(name: str) -> type[Dialect]:
    """The dialect of a name or a synonym; raises ProgramError where there is none."""
    found = _dialects().get(name.lower())
    if found is None:
        raise ProgramError(f"unknown dialect '{name}'",
                           accepted="auto, " + ", ".join(dialect_names()))  # fmt: skip
    return found


def dialect_name(name: str) -> str:
    """The one name of a dialect that may be called by a synonym; ``auto`` stays.

    Raises
    ------
    ProgramError
        There is no such dialect.
    """
    return "auto" if name.lower() == "auto" else dialect_called(name).name


@dataclass(frozen=True)
class Recognition:
    """Which dialect a program is read in, and why."""

    dialect: type[Dialect]
    reason: str
    is_fallback: bool = False  #: nothing in the text says it

    def __str__(self) -> str:
        return f"read as {self.dialect.title} ({self.dialect.name}): {self.reason}"


def choose_dialect(
    name: str, data: bytes, *, path: str | Path = "", whole: bool = False
) -> Recognition:
    """The dialect of a name; for ``auto`` the one whose marks are found in the text.

    Where none are, the ending of the file's name says it, if it is that of one control alone.

    Parameters
    ----------
    name : str
    data : bytes
        The program.
    path : str or Path
        Its file.
    whole : bool
        Search all of it, and not its head alone.
    """
    if name.lower() != "auto":
        return Recognition(dialect_called(name), "as told")
    text = (data if whole else data[:_HEAD]).decode("latin-1")
    for kind in dict.fromkeys(_dialects().values()):
        reason = kind.detect(text)
        if reason is not None:
            return Recognition(kind, reason)
    ending = Path(path).suffix
    for kind in dict.fromkeys(_dialects().values()):
        if ending.lower() in kind.file_endings:
            return Recognition(kind, f"the file's name ends in {ending}")
    return Recognition(_dialects()[_FALLBACK], "it has no word of another control", True)


def dialect_of(path: str | Path, name: str = "auto") -> str:
    """The dialect in which `read_program` will read a file; arguments and errors as there."""
    with Path(path).open("rb") as file:
        return choose_dialect(name, file.read(_HEAD), path=path).dialect.name
