"""Effects of a job that were fitted to its own readings: with further ones they are fitted anew.

What was fitted alone has taken a part of what another effect does. It would keep it, whatever is
added to it later.
"""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping, MutableMapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import tomlkit

from vmach.effects import label_of
from vmach.errors import InputError
from vmach.files.toml_file import line_of_key
from vmach.history.job_text import checked_job, parsed_job, take_fits
from vmach.job import Job, read_job
from vmach.job.path_keys import change_paths

__all__ = [
    "Key",
    "check_new",
    "fitted_before",
    "is_there",
    "take_effects",
    "without_effects",
    "without_tables",
]

#: name and target of an effect
Key = tuple[str, str]


def fitted_before(job: Job) -> tuple[Key, ...]:
    """Effects that were added to a job by a fit to readings that it still has, in its order.

    The chain of jobs tells it. Those of another part, and those that were set, are known.
    """
    found: set[Key] = set()
    here, seen = job, {job.path.resolve()}
    while (before := _before(here)) is not None and before.path.resolve() not in seen:
        if not _has_all(job, before):
            break
        seen.add(before.path.resolve())
        found |= here.fitted.keys() - before.fitted.keys()
        here = before
    return tuple(key for key in job.fitted if key in found and is_there(job.effects, *key))


def _before(job: Job) -> Job | None:
    """The job that a job goes on from, where it can still be read."""
    if not job.history or "previous" not in job.history[-1]:
        return None
    try:
        return read_job(job.folder / job.history[-1]["previous"])
    except InputError:  # nobody needs it but who asks for the history
        return None


def _has_all(job: Job, before: Job) -> bool:
    """Whether a job has all readings of the job before, and perhaps more."""
    now, then = _readings(job), _readings(before)
    same_part = then["measured"] in (None, now["measured"])
    return same_part and all(one in now["measurements"] for one in then["measurements"])


def _readings(job: Job) -> dict[str, Any]:
    """What was measured, files by their places."""
    told = {
        "measured": None if job.measured is None else str(job.measured),
        "measurements": [dict(one) for one in job.measurements],
    }
    change_paths(told, lambda name: str((job.folder / name).resolve()))
    return told


def without_effects(job: Job, keys: Collection[Key]) -> Job:
    """The job without some of its effects, and what was left open of them."""
    effects = dict(job.effects)
    effects |= {name: dict(effects[name]) for name, _ in keys}
    take_effects(effects, keys)
    return replace(
        job,
        effects=effects,
        fitted={key: changes for key, changes in job.fitted.items() if key not in keys},
        correlated={
            pair: values for pair, values in job.correlated.items() if not set(pair) & set(keys)
        },
    )


def without_tables(text: str, keys: Collection[Key], *, file: Path) -> str:
    """The text of a job without these effects.

    Raises
    ------
    InputError
        The text of `file` is written in a way that cannot be changed.
    """
    if not keys:
        return text
    document, wanted = parsed_job(text, file), tomllib.loads(text)
    for data in (document, wanted):
        _take_tables(data, keys)
    return checked_job(tomlkit.dumps(document), wanted, file=file)


def _take_tables(data: MutableMapping[str, Any], keys: Collection[Key]) -> None:
    take_effects(data["effects"], keys)
    if not data["effects"]:
        del data["effects"]
    take_fits(data, keys)


def take_effects(effects: MutableMapping[str, Any], keys: Collection[Key]) -> None:
    """Take effects out of the table of all; one has a table of its own, or that of its name."""
    for name, target in keys:
        table = effects[name]
        if isinstance(table.get(target), Mapping):
            del table[target]
        else:
            for key in [key for key, value in table.items() if not isinstance(value, Mapping)]:
                del table[key]
        if not table:
            del effects[name]


def is_there(effects: Mapping[str, Any], name: str, target: str) -> bool:
    """Whether the table of all effects has one."""
    table = effects.get(name)
    if not isinstance(table, Mapping):
        return False
    plain = {key: value for key, value in table.items() if not isinstance(value, Mapping)}
    return (target in table.keys() - plain.keys()) or (
        bool(plain) and plain.get("target", "") == target
    )


def check_new(job: Job, text: str, name: str, target: str) -> None:
    """Complain about an effect that the job has.

    Raises
    ------
    InputError
        It is there already.
    """
    if is_there(job.effects, name, target):
        raise InputError(
            f"the job has the effect {label_of(name, target)} already",
            file=job.path,
            line=line_of_key(text, ["effects", name, target]),
            hint="take it out of the job first, or go on from the job before it",
        )
