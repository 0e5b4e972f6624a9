"""Plug-ins: what the files of a folder, and the entry points of other packages, offer."""

from __future__ import annotations

import pkgutil
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import TypeVar

from vmach.errors import InputError

__all__ = ["classes_in", "classes_of", "line_in", "loading", "modules_of", "offered"]

Kind = TypeVar("Kind")


def classes_of(
    folder: ModuleType, group: str, base: type[Kind], *, what: str, in_every_file: bool = False
) -> Iterator[type[Kind]]:
    """Classes that the files of a folder hold, then those that entry points of a group name.

    Parameters
    ----------
    folder : package
        Its own packages are searched too.
    group : str
        Of the entry points.
    base : type
        What the classes are derived from.
    what : str
        What one of them is, for messages.
    in_every_file : bool
        Whether a file without one is an error.

    Raises
    ------
    InputError
        A file or an entry point cannot be loaded, or is something else.
    """
    found = []
    for module, file in modules_of(folder, what=what):
        kinds = classes_in(module, base)
        if in_every_file and not kinds:
            raise InputError(
                f"no {what} in the file", file=file, accepted=f"a subclass of {base.__name__}"
            )
        found += kinds
    # once all files are loaded it is known what several classes have in common
    yield from (kind for kind in found if "name" in vars(kind) or not kind.__subclasses__())
    accepted = f"MODULE:CLASS of a subclass of {base.__name__}"
    for entry, kind in offered(group, accepted=accepted):
        if not (isinstance(kind, type) and issubclass(kind, base)):
            raise InputError(f"{_said(entry)} is {kind!r}", accepted=accepted, hint=_owner(entry))
        yield kind


def modules_of(folder: ModuleType, *, what: str) -> Iterator[tuple[ModuleType, Path]]:
    """Every file of a package and of the packages in it, imported."""
    for found in pkgutil.walk_packages(folder.__path__, f"{folder.__name__}."):
        spec = find_spec(found.name)
        if not found.ispkg and spec is not None and spec.origin is not None:
            file = Path(spec.origin)
            with loading(file, what):
                module = import_module(found.name)
            yield module, file


def classes_in(module: ModuleType, base: type[Kind]) -> list[type[Kind]]:
    """Subclasses that a module itself defines."""
    return [
        value
        for value in vars(module).values()
        if isinstance(value, type)
        and issubclass(value, base)
        and value.__module__ == module.__name__
    ]


def offered(group: str, *, accepted: str) -> Iterator[tuple[EntryPoint, object]]:
    """The entry points of a group by their names, with what they load.

    Raises
    ------
    InputError
        One of them cannot be loaded.
    """
    for entry in sorted(entry_points(group=group), key=lambda entry: entry.name):
        try:
            yield entry, entry.load()
        except (Exception, SystemExit) as error:
            raise InputError(
                f"{_said(entry)} cannot be loaded: {_in_words(error)}",
                file=(file := _file_of(entry)),
                line=None if file is None else line_in(file, error),
                accepted=accepted,
                hint=_owner(entry),
            ) from error


def _said(entry: EntryPoint) -> str:
    return f"entry point '{entry.name} = {entry.value}' of {entry.group}"


def _owner(entry: EntryPoint) -> str | None:
    return None if entry.dist is None else f"it belongs to the package {entry.dist.name}"


def _file_of(entry: EntryPoint) -> Path | None:
    try:
        spec = find_spec(entry.module)
    except ImportError:
        return None
    return None if spec is None or spec.origin is None else Path(spec.origin)


@contextmanager
def loading(file: Path, what: str) -> Iterator[None]:
    """Tell what goes wrong while a file of Python is loaded by its line."""
    try:
        yield
    except (Exception, SystemExit) as error:
        raise InputError(
            f"{what} file cannot be loaded: {_in_words(error)}",
            file=file,
            line=line_in(file, error),
        ) from error


def _in_words(error: BaseException) -> str:
    """What is wrong, with the line's text where Python cannot read it."""
    if isinstance(error, SyntaxError):
        return f"{error.msg}: '{(error.text or '').strip()}'"
    return f"{type(error).__name__}: {error}"


def line_in(file: Path, error: BaseException) -> int | None:
    """The line of a file that an error comes from."""
    if isinstance(error, SyntaxError):
        return error.lineno
    frames = traceback.extract_tb(error.__traceback__)
    lines = [f.lineno for f in frames if Path(f.filename).resolve() == file.resolve()]
    return lines[-1] if lines else None
