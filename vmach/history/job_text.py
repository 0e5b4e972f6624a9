"""The text of a user's job, changed: what it says afterwards is checked before it is written."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Collection, Mapping, MutableMapping
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError

from vmach.errors import InputError
from vmach.files.toml_file import line_of_key

__all__ = ["checked_job", "in_tables", "parsed_job", "take_fits", "with_tables"]

#: tables of a job that a following one adds to
_GROWING = ("effects", "fitted", "correlated", "history")


def parsed_job(text: str, file: Path) -> tomlkit.TOMLDocument:
    """A job's text, so that it can be changed and keeps its comments.

    Raises
    ------
    InputError
        It is written in a way that cannot be changed.
    """
    try:
        return tomlkit.parse(text)
    except TOMLKitError as error:
        raise _rigid(file, f"the file cannot be changed: {error}") from None


def checked_job(text: str, wanted: Mapping[str, Any], *, file: Path) -> str:
    """The text, if it says what is wanted.

    Raises
    ------
    InputError
        It says something else, because of the way in which `file` is written.
    """
    if _says(text, wanted):
        return text
    said = file.read_text(encoding="utf-8-sig")
    line = next(filter(None, (line_of_key(said, [key]) for key in _GROWING)), None)
    raise _rigid(file, "the file cannot be changed as it is written", line)


def with_tables(text: str, more: str, *, file: Path) -> str:
    """A job's text with further effects, fitted changes and history behind it.

    Where these are written inline they get tables of their own first.

    Raises
    ------
    InputError
        They are written in a way that cannot be changed.
    """
    wanted, added = tomllib.loads(text), tomllib.loads(more)
    longer = _joined(text, more)
    if _says(longer, _with_both(wanted, added)):
        return longer
    longer = _joined(in_tables(text, file), more)
    return checked_job(longer, _with_both(wanted, added), file=file)


def in_tables(text: str, file: Path) -> str:
    """A job's text with effects, fitted changes and history under headers of their own."""
    document = parsed_job(text, file)
    kept = {key: document.pop(key).unwrap() for key in _GROWING if key in document}
    plain = tomlkit.dumps({key: value for key, value in kept.items() if value})
    return _joined(tomlkit.dumps(document), plain)


def take_fits(job: MutableMapping[str, Any], keys: Collection[tuple[str, str]]) -> None:
    """Take out what fits left open of effects, told by name and target."""
    words = {f"{name}:{target}".rstrip(":") for name, target in keys}
    _take_out(job, "fitted", lambda e: (e.get("effect"), e.get("target", "")) in keys)
    _take_out(job, "correlated", lambda e: not words.isdisjoint(e.get("effects", ())))


def _take_out(job: MutableMapping[str, Any], key: str, is_one: Callable[[Any], bool]) -> None:
    """Take entries out of a list of tables, and the list where none is left."""
    entries: Any = job.get(key, [])
    for k in reversed(range(len(entries))):
        if is_one(entries[k]):
            del entries[k]
    if key in job and not len(entries):
        del job[key]


def _joined(text: str, more: str) -> str:
    return f"{text.rstrip()}\n\n{more.lstrip()}" if more else text


def _with_both(one: Mapping[str, Any], other: Mapping[str, Any]) -> dict[str, Any]:
    """Two tables as one: tables in them grow, and lists."""
    both = dict(one)
    for key, value in other.items():
        here = both.get(key)
        if isinstance(here, dict) and isinstance(value, dict):
            both[key] = _with_both(here, value)
        elif isinstance(here, list) and isinstance(value, list):
            both[key] = here + value
        else:
            both[key] = value
    return both


def _says(text: str, wanted: Mapping[str, Any]) -> bool:
    """Whether it is TOML with these values, and without empty tables of those that grow."""
    try:
        text.encode()  # names of files may have bytes that no text can hold
        said = tomllib.loads(text)
    except ValueError:
        return False
    return _without_empty(said) == _without_empty(wanted)


def _without_empty(data: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in data.items() if value or key not in _GROWING}


def _rigid(file: Path, what: str, line: int | None = None) -> InputError:
    return InputError(
        what,
        file=file,
        line=line,
        accepted="tables under headers: [effects.NAME.TARGET], [[fitted]], [[history]]",
        hint="write this table so, or edit the file by hand",
    )
