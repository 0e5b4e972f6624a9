"""The importers there are: files of the folder ``kinds``, and those of other packages."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from vmach.errors import InputError
from vmach.files.declaration import Declaration
from vmach.files.plugins import classes_of
from vmach.importers import kinds
from vmach.importers.importer import Importer

__all__ = ["ENTRY_POINT", "catalogue", "check_declaration"]

#: group of entry points under which a package offers its own importers
ENTRY_POINT = "vmach.importers"


@lru_cache(maxsize=1)
def catalogue() -> dict[str, Importer]:
    """Every known importer by its name, in order of rank.

    Raises
    ------
    InputError
        A file of the folder, or an entry point of another package, is no importer.
    """
    found: dict[str, Importer] = {}
    for kind in classes_of(kinds, ENTRY_POINT, Importer, what="importer", in_every_file=True):  # type: ignore[type-abstract]
        check_declaration(kind)
        if kind.name in found:
            raise InputError(
                f"importer class {kind.__name__}: name = '{kind.name}' is that of "
                f"{type(found[kind.name]).__module__} too",
                accepted="a name of its own",
            )
        found[kind.name] = kind()
    return dict(sorted(found.items(), key=lambda item: (item[1].rank, item[0])))


def check_declaration(kind: type[Importer]) -> None:
    """Refuse a class that does not say what an importer has to say.

    Raises
    ------
    InputError
        With the file and the line of what is missing, misspelt or wrong.
    """
    said = Declaration(kind, Importer, "importer")
    said.check_known()
    said.check_name()
    said.check_words(("title", "reads"))
    if not isinstance(kind.rank, int):
        raise said.error(f"rank = {kind.rank!r}", key="rank", accepted="a whole number")
    if not _is_words(kind.keys):
        accepted = "a dictionary of names and meanings"
        raise said.error(f"keys = {kind.keys!r}", key="keys", accepted=accepted)
    for name, call in (("recognises", "source"), ("read", "source, questions")):
        if getattr(kind, name) is getattr(Importer, name):
            raise said.error(f"{name}() is missing", accepted=f"def {name}(self, {call})")


def _is_words(keys: Any) -> bool:
    return isinstance(keys, dict) and all(
        isinstance(word, str) and word for pair in keys.items() for word in pair
    )
