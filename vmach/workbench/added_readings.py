"""Readings that come later: a new job beside the old one that names them too."""

from __future__ import annotations

import contextlib
import json
import re
import tomllib
from collections.abc import Mapping

__all__ = ["READINGS_OF_PART", "job_with_readings"]

#: the kind of points of the part itself, which a job names by its key `measured`
READINGS_OF_PART = "part"
_MEASURED = re.compile(r"^\s*measured\s*=.*$", re.MULTILINE)
_FIRST_TABLE = re.compile(r"^\s*\[", re.MULTILINE)


def job_with_readings(text: str, previous: str, file: str, settings: Mapping[str, object]) -> str:
    """The text of a job that has further readings, and says which job it came from.

    Parameters
    ----------
    text : str
        Of the job so far.
    previous : str
        Name of its file.
    file : str
        The readings.
    settings : mapping
        ``kind`` and what else its section takes; of kind "part" the key `measured` is set.
    """
    added = f"readings {file}"
    if settings["kind"] == READINGS_OF_PART:
        added += _in_place_of(text)
        text = _with_key(text, f"measured = {json.dumps(file)}")
    else:
        lines = [f"{key} = {json.dumps(value)}" for key, value in settings.items()]
        lines.insert(1, f"file = {json.dumps(file)}")
        text = text.rstrip() + "\n\n[[measurements]]\n" + "\n".join(lines) + "\n"
    return text.rstrip() + (
        f"\n\n[[history]]\nprevious = {json.dumps(previous)}\nadded = {json.dumps([added])}\n"
    )


def _in_place_of(text: str) -> str:
    """Which readings the part had before: a job names one file of them."""
    with contextlib.suppress(ValueError):  # a job that is no TOML is refused when it is read
        before = tomllib.loads(text).get("measured")
        return f" in place of {before}" if before else ""
    return ""


def _with_key(text: str, line: str) -> str:
    """The text with the key `measured` set, before the first table."""
    if _MEASURED.search(text):
        return _MEASURED.sub(lambda _: line, text, count=1)
    first = _FIRST_TABLE.search(text)
    at = len(text) if first is None else first.start()
    return f"{text[:at].rstrip()}\n{line}\n\n{text[at:].lstrip()}"
