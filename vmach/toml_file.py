"""TOML files read into checked records; every complaint names file, line and key."""

from __future__ import annotations

import difflib
import re
import tomllib
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from vmach.errors import InputError

__all__ = ["FileSection", "line_of_key", "read_text", "read_toml"]


class FileSection(BaseModel):
    """A table of a TOML file: unknown keys and values of another type are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=False)


Section = TypeVar("Section", bound=FileSection)


def read_text(path: Path, *, what: str) -> str:
    """Text of a file, or an `InputError` that says which file is missing or unreadable."""
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{what} not found", file=path) from None
    except IsADirectoryError:
        raise InputError(f"{what} is a folder, not a file", file=path) from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{what} cannot be read: {error}", file=path) from None


def read_toml(path: Path, schema: type[Section], *, what: str) -> Section:
    """Read a TOML file and check it against a schema.

    Parameters
    ----------
    path : Path
    schema : subclass of FileSection
    what : str
        What the file is, for messages: "job file", "machine file".

    Raises
    ------
    InputError
        Missing file, no TOML, unknown key, wrong type or value; with line and key.
    """
    text = read_text(path, what=what)
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        found = re.search(r"at line (\d+)", str(error))
        line = int(found.group(1)) if found else None
        raise InputError(f"{what} is not valid TOML: {error}", file=path, line=line) from None
    try:
        return schema.model_validate(data)
    except ValidationError as error:
        raise _first_complaint(error, path, text, schema) from None


def _first_complaint(
    error: ValidationError, path: Path, text: str, schema: type[FileSection]
) -> InputError:
    complaints = error.errors()
    # a misspelt key is also a missing one: say what was written first
    first = min(complaints, key=lambda c: c["type"] != "extra_forbidden")
    keys = [str(part) for part in first["loc"]]
    dotted = ".".join(keys)
    line = line_of_key(text, keys)
    if first["type"] == "extra_forbidden":
        known = _known_keys(schema, keys[:-1])
        close = difflib.get_close_matches(keys[-1], known, n=1)
        hint = f"did you mean '{close[0]}'?" if close else None
        return InputError(
            f"unknown key '{dotted}'", file=path, line=line, accepted=", ".join(known), hint=hint
        )
    if first["type"] == "missing":
        parent = line_of_key(text, keys[:-1])
        return InputError(f"key '{dotted}' is missing", file=path, line=parent)
    message = first["msg"].removeprefix("Value error, ")
    return InputError(f"'{dotted}' = {first['input']!r}: {message}", file=path, line=line)


def _known_keys(schema: type[FileSection], keys: list[str]) -> list[str]:
    """Names accepted in the table that `keys` lead to, as far as the schema tells."""
    current: type = schema
    for key in keys:
        fields = getattr(current, "model_fields", {})
        names = {(field.alias or name): field for name, field in fields.items()}
        if key in names:
            current = _section_in(names[key].annotation) or current
    return [field.alias or name for name, field in current.model_fields.items()]


def _section_in(annotation: object) -> type[FileSection] | None:
    """The `FileSection` inside an annotation such as ``dict[str, Tool] | None``."""
    if isinstance(annotation, type) and issubclass(annotation, FileSection):
        return annotation
    for part in getattr(annotation, "__args__", ()):
        found = _section_in(part)
        if found is not None:
            return found
    return None


def line_of_key(text: str, keys: list[str]) -> int | None:
    """1-based line where a dotted key, or the closest table above it, is written."""
    lines = text.splitlines()
    table: list[str] = []
    best, depth = None, 0
    for number, line in enumerate(lines, 1):
        header = re.match(r"\s*\[+\s*([^\]]+?)\s*\]+", line)
        assignment = re.match(r"\s*([A-Za-z0-9_.\"'-]+)\s*=", line)
        if header:
            table = _split_key(header.group(1))
            here = table
        elif assignment:
            here = table + _split_key(assignment.group(1))
        else:
            continue
        path = [key for key in keys if not key.isdigit() or key in here]
        if here == path[: len(here)] and len(here) > depth:
            best, depth = number, len(here)
    return best


def _split_key(dotted: str) -> list[str]:
    return [part.strip().strip("\"'") for part in dotted.split(".")]
