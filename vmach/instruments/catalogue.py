"""The instruments there are: files of the folder ``kinds``, and those of other packages."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

from vmach.errors import InputError
from vmach.files.plugins import classes_of
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
    for kind in classes_of(kinds, ENTRY_POINT, Instrument, what="instrument", in_every_file=True):
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
