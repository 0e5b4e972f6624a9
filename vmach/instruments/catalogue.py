"""The instruments there are: files of the folder ``kinds``, and those of other packages."""

from __future__ import annotations

import pkgutil
import traceback
from collections.abc import Iterator
from functools import lru_cache
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path

from vmach.errors import InputError
from vmach.instruments import kinds
from vmach.instruments.declaration import check_declaration
from vmach.job import Job
from vmach.measurements.instrument import Instrument, PlannedTest

__all__ = ["ENTRY_POINT", "catalogue", "planned_tests"]

#: group of entry points under which a package offers its own instruments
ENTRY_POINT = "vmach.instruments"


@lru_cache(maxsize=1)
def catalogue() -> dict[str, type[Instrument]]:
    """Every known instrument by its name, the most frequent first.

    Raises
    ------
    InputError
        A file of the folder, or an entry point of another package, is no instrument.
    """
    found: dict[str, type[Instrument]] = {}
    for kind in (*_of_folder(), *_of_packages()):
        check_declaration(kind)
        if kind.name in found:
            raise InputError(
                f"instrument class {kind.__name__}: name = '{kind.name}' is that of "
                f"{found[kind.name].__module__} too",
                accepted="a name of its own",
            )
        found[kind.name] = kind
    return dict(sorted(found.items(), key=lambda item: -item[1].commonness))


def planned_tests(job: Job) -> Iterator[PlannedTest]:
    """Tests that can be run on a job's machine, those of the most frequent instruments first."""
    for instrument in catalogue().values():
        yield from instrument.planned(job)


def _of_folder() -> Iterator[type[Instrument]]:
    for folder in kinds.__path__:
        for module in sorted(pkgutil.iter_modules([folder]), key=lambda one: one.name):
            yield _in_module(f"{kinds.__name__}.{module.name}", Path(folder) / f"{module.name}.py")


def _in_module(name: str, file: Path) -> type[Instrument]:
    """The one instrument of a file."""
    try:
        module = import_module(name)
    except Exception as error:
        raise InputError(
            f"instrument file cannot be loaded: {error}", file=file, line=_line_in(file, error)
        ) from error
    found = [
        value
        for value in vars(module).values()
        if isinstance(value, type)
        and issubclass(value, Instrument)
        and value.__module__ == module.__name__
    ]
    if len(found) != 1:
        raise InputError(
            f"{len(found)} instruments in the file", file=file, accepted="one class of Instrument"
        )
    return found[0]


def _of_packages() -> Iterator[type[Instrument]]:
    for entry in entry_points(group=ENTRY_POINT):
        try:
            kind = entry.load()
        except Exception as error:
            raise InputError(
                f"entry point '{entry.name} = {entry.value}' of {ENTRY_POINT} cannot be loaded: "
                f"{error}",
                accepted="MODULE:CLASS of a subclass of Instrument",
                hint=None if entry.dist is None else f"it belongs to the package {entry.dist.name}",
            ) from error
        if not (isinstance(kind, type) and issubclass(kind, Instrument)):
            raise InputError(
                f"entry point '{entry.name} = {entry.value}' of {ENTRY_POINT} is {kind!r}",
                accepted="MODULE:CLASS of a subclass of Instrument",
            )
        yield kind


def _line_in(file: Path, error: Exception) -> int | None:
    """The line of a file that an error comes from."""
    if isinstance(error, SyntaxError):
        return error.lineno
    frames = traceback.extract_tb(error.__traceback__)
    lines = [f.lineno for f in frames if Path(f.filename).resolve() == file.resolve()]
    return lines[-1] if lines else None
