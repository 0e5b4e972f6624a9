"""Files that a job names, found without reading the job: it may be one that cannot be read."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

__all__ = ["named_files"]

#: what a job says of itself, not of its files
_NOT_READ = ("history",)
_MOST = 500
_LONGEST = 400


def named_files(job: Path) -> list[Path]:
    """The files that a job and its machine name, also those that are not there.

    Nothing but the job itself where it is no TOML.
    """
    of_job = list(_named_in(job))
    of_machine = [p for one in of_job if one.suffix == ".toml" for p in _named_in(one)]
    return list(dict.fromkeys([job, *of_job, *of_machine]))[:_MOST]


def _named_in(file: Path) -> Iterator[Path]:
    try:
        told = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return
    for word in _words({key: one for key, one in told.items() if key not in _NOT_READ}):
        path = Path(word)
        if path.suffix and len(word) <= _LONGEST and "\0" not in word:
            path = file.parent / path
            if not path.is_dir():
                yield path


def _words(told: Any) -> Iterator[str]:
    """All texts in a structure of TOML."""
    if isinstance(told, str):
        yield told
    elif isinstance(told, dict):
        for one in told.values():
            yield from _words(one)
    elif isinstance(told, list):
        for one in told:
            yield from _words(one)
