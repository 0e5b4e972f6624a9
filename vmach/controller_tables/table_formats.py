"""The formats there are: files of the folder ``formats``, and those of other packages.

Each file offers ``FORMATS``, a tuple of `TableFormat`.
"""

from __future__ import annotations

import pkgutil
from collections.abc import Iterator
from importlib import import_module
from importlib.metadata import entry_points

from vmach.controller_tables import formats
from vmach.controller_tables.table_format import TableFormat
from vmach.errors import InputError

__all__ = ["ENTRY_POINT", "FORMATS"]

#: group of entry points under which a package offers its own formats
ENTRY_POINT = "vmach.table_formats"


def _modules() -> Iterator[tuple[str, object]]:
    """Where formats stand, and what stands there."""
    for module in pkgutil.iter_modules(formats.__path__):
        name = f"{formats.__name__}.{module.name}"
        yield name, getattr(import_module(name), "FORMATS", None)
    for entry in entry_points(group=ENTRY_POINT):
        try:
            yield entry.value, entry.load()
        except Exception as error:
            raise InputError(
                f"entry point '{entry.name} = {entry.value}' of {ENTRY_POINT} cannot be loaded: "
                f"{error!r}",
                accepted="MODULE:FORMATS, a tuple of TableFormat",
            ) from error


def _catalogue() -> dict[str, TableFormat]:
    """Every format by its name, in order of rank.

    Raises
    ------
    InputError
        A file or an entry point without formats, or a name that is taken.
    """
    found: dict[str, TableFormat] = {}
    for where, offered in _modules():
        if not isinstance(offered, tuple) or not all(isinstance(o, TableFormat) for o in offered):
            raise InputError(
                f"{where} offers {offered!r}", accepted="FORMATS, a tuple of TableFormat"
            )
        for one in offered:
            if one.name in found:
                raise InputError(f"{where}: the name '{one.name}' is taken", accepted="another")
            found[one.name] = one
    return dict(sorted(found.items(), key=lambda item: item[1].rank))


#: by the name that the command line and the folders use
FORMATS: dict[str, TableFormat] = _catalogue()
