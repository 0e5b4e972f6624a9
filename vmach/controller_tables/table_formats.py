"""The formats there are: files of the folder ``formats``, and those of other packages.

Each file offers ``FORMATS``, a tuple of `TableFormat`.
"""

from __future__ import annotations

from collections.abc import Iterator

from vmach.controller_tables import formats
from vmach.controller_tables.table_format import TableFormat
from vmach.errors import InputError
from vmach.files.plugins import modules_of, offered

__all__ = ["ENTRY_POINT", "FORMATS"]

#: group of entry points under which a package offers its own formats
ENTRY_POINT = "vmach.table_formats"


def _offers() -> Iterator[tuple[str, object]]:
    """Where formats stand, and what stands there."""
    for module, file in modules_of(formats, what="table format"):
        yield str(file), getattr(module, "FORMATS", None)
    for entry, found in offered(ENTRY_POINT, accepted="MODULE:FORMATS, a tuple of TableFormat"):
        yield entry.value, found


def _catalogue() -> dict[str, TableFormat]:
    """Every format by its name, in order of rank.

    Raises
    ------
    InputError
        A file or an entry point without formats, or a name that is taken.
    """
    found: dict[str, TableFormat] = {}
    for where, these in _offers():
        if not isinstance(these, tuple) or not all(isinstance(o, TableFormat) for o in these):
            raise InputError(
                f"{where} offers {these!r}", accepted="FORMATS, a tuple of TableFormat"
            )
        for one in these:
            if one.name in found:
                raise InputError(f"{where}: the name '{one.name}' is taken", accepted="another")
            found[one.name] = one
    return dict(sorted(found.items(), key=lambda item: item[1].rank))


#: by the name that the command line and the folders use
FORMATS: dict[str, TableFormat] = _catalogue()
