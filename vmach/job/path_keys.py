"""Keys of a job file that name files or folders, as its schema says."""

from __future__ import annotations

from collections.abc import Callable, Iterator, MutableMapping, MutableSequence
from typing import Annotated, Any, get_args, get_origin

from vmach.files.toml_file import FileSection
from vmach.job.schema import FILE_KEY, FILE_NAME, JobSchema

__all__ = ["change_paths", "path_keys"]

#: stands for every key of a table, and for every entry of a list
ANY = "*"


def path_keys() -> tuple[tuple[str, ...], ...]:
    """Keys that lead to the name of a file or a folder; ``*`` stands for any key or entry.

    Examples
    --------
    >>> from vmach.job.path_keys import path_keys
    >>> [".".join(keys) for keys in path_keys()][:3]
    ['machine', 'program', 'control.subprograms']
    """
    return tuple(_of_section(JobSchema))


def _of_section(schema: type[FileSection]) -> Iterator[tuple[str, ...]]:
    for name, field in schema.model_fields.items():
        if FILE_NAME in field.metadata:
            yield (name,)
        else:
            yield from ((name, *keys) for keys in _of_type(field.annotation))


def _of_type(annotation: Any) -> Iterator[tuple[str, ...]]:
    """Keys below a value of a type."""
    if isinstance(annotation, type) and issubclass(annotation, FileSection):
        yield from _of_section(annotation)
        return
    parts, origin = get_args(annotation), get_origin(annotation)
    if origin is Annotated:
        if FILE_NAME in parts[1:]:
            yield ()
        elif FILE_KEY in parts[1:]:
            yield (FILE_KEY,)
        else:
            yield from _of_type(parts[0])
    elif origin in (dict, list):
        yield from ((ANY, *keys) for keys in _of_type(parts[-1]))
    else:
        for part in parts:
            yield from _of_type(part)


def change_paths(data: Any, changed: Callable[[str], str]) -> None:
    """Put another name in the place of every file name that a job's data has."""
    for keys in path_keys():
        _change(data, keys, changed)


def _change(here: Any, keys: tuple[str, ...], changed: Callable[[str], str]) -> None:
    key, *rest = keys
    for one in _inside(here, key):
        if rest:
            _change(here[one], tuple(rest), changed)
        elif isinstance(here[one], str):
            here[one] = changed(str(here[one]))


def _inside(here: Any, key: str) -> list[Any]:
    """Keys of a table, or places of a list, that a key stands for."""
    if isinstance(here, MutableMapping):
        return list(here) if key == ANY else [key] * (key in here)
    return list(range(len(here))) if isinstance(here, MutableSequence) and key == ANY else []
