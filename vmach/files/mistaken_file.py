"""A file that was named by mistake: what its content says that it is."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from vmach.errors import InputError

__all__ = ["mistaken_for"]

#: how programs begin and TOML files do not: a percent sign, a comment, a word with a number
_BEGINS_AS_A_PROGRAM = re.compile(r"\s*(?:[%(;]|\d+ BEGIN PGM|/?[A-Z]{1,3} ?-?\d)", re.IGNORECASE)
#: two names or more with commas or semicolons between them, and nothing else
_BEGINS_AS_A_TABLE = re.compile(r"\s*\w+(?:\s*[,;]\s*\w+)+\s*(?:\n|$)")

#: keys that a file of one kind has and files of the others have not
_TELLTALES = {
    "job file": {"program", "machine"},
    "machine file": {"convention"},
    "study file": {"cases"},
}
#: what each is for
_SAYS = {
    "job file": "a job file, which names program, machine and tools",
    "machine file": "a machine file, which names axes and tables of errors",
    "study file": "a study file, which names cases and a function",
}


def mistaken_for(
    path: Path, text: str, data: Mapping[str, Any] | None, *, what: str
) -> InputError | None:
    """The complaint about a file of another kind than it should be, if its content tells.

    Parameters
    ----------
    path, text : Path, str
    data : mapping or None
        What it holds as TOML; None if it is none.
    what : str
        What it should be: "job file", "machine file", ...
    """
    accepted = _SAYS.get(what, f"a {what}")
    if data is not None:
        kinds = [kind for kind, keys in _TELLTALES.items() if keys <= data.keys()]
        if what in kinds or not kinds:
            return None
        named = data.get("machine") if what == "machine file" else None
        hint = f"is it {path.parent / named}?" if isinstance(named, str) else None
        return InputError(f"is a {kinds[0]} by its keys", file=path, accepted=accepted, hint=hint)
    if path.suffix.lower() == ".toml":
        return None
    if _BEGINS_AS_A_PROGRAM.match(text):
        begins = "an NC program"
    elif _BEGINS_AS_A_TABLE.match(text):
        begins = "a table"
    else:
        return None
    return InputError(
        f"begins as {begins} does", file=path, accepted=accepted, hint=_beside(path, what)
    )


def _beside(path: Path, what: str) -> str | None:
    """Where a file of the right kind is, or what writes one."""
    if what not in ("job file", "machine file"):
        return None
    there = path.parent / f"{what.split()[0]}.toml"
    return f"is it {there}?" if there.is_file() else "'vmach init' writes one"
