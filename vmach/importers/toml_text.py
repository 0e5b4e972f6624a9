"""Sections as TOML text, and put into a file that is there: what stands in it stays as it is."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from vmach.errors import InputError
from vmach.files.toml_file import line_of_key
from vmach.importers.importer import Section

__all__ = ["section_text", "text_with"]

_ANY_TABLE = re.compile(r"^[ \t]*\[", re.MULTILINE)


def section_text(section: Section) -> str:
    """A table with its keys, as it can be pasted."""
    keys = _keys_text(section)
    if not section.table:
        return keys
    head = f"[[{section.table}]]" if section.is_array else f"[{section.table}]"
    return f"\n{head}\n{keys}"


def _keys_text(section: Section) -> str:
    lines = [f"{key} = {_value(value)}\n" for key, value in section.values.items()]
    if section.comment and lines:
        lines[0] = f"{lines[0].rstrip()}  # {section.comment}\n"
    return "".join(lines)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    return f"{value:.10g}" if isinstance(value, float) else json.dumps(value, ensure_ascii=False)


def text_with(text: str, sections: Iterable[Section], *, file: Path) -> str:
    """The text of a TOML file with further sections.

    Parameters
    ----------
    text : str
    sections : iterable of Section
    file : Path
        For messages.

    Raises
    ------
    InputError
        A key that is there already, or a text that is no TOML.
    """
    for section in sections:
        said = _parsed(text, file)
        if section.is_array:
            longer = text.rstrip("\n") + "\n" + section_text(section)
            text = _checked(longer, text, section, file)
            continue
        there = _table(said, section.table)
        for key in section.values:
            if there is not None and key in there:
                keys = [*section.table.split("."), key] if section.table else [key]
                raise InputError(
                    f"{'.'.join(keys)} is there already",
                    file=file,
                    line=line_of_key(text, keys),
                    accepted="a file that does not say it yet",
                    hint="take the old lines out first, or paste the new ones by hand",
                )
        longer = _with_keys(text, section, is_there=there is not None)
        text = _checked(longer, text, section, file)
    return text


def _checked(longer: str, text: str, section: Section, file: Path) -> str:
    """The longer text, if it is TOML; it is none where a table is written inline."""
    try:
        tomllib.loads(longer)
    except ValueError:
        key = section.table.split(".")[0] or next(iter(section.values))
        raise InputError(
            f"'{key}' is written in one line, and [{section.table}] cannot be added to it",
            file=file,
            line=line_of_key(text, [key]),
            accepted=f"a header for each of its tables: [{section.table}]",
            hint="write it so, or paste the new lines by hand",
        ) from None
    return longer


def _parsed(text: str, file: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f"is not valid TOML: {error}", file=file, accepted="TOML") from None


def _table(said: dict[str, Any], dotted: str) -> dict[str, Any] | None:
    here: Any = said
    for key in filter(None, dotted.split(".")):
        here = here.get(key) if isinstance(here, dict) else None
    return here if isinstance(here, dict) else None


def _with_keys(text: str, section: Section, *, is_there: bool) -> str:
    if not section.table:
        first = _ANY_TABLE.search(text)
        at = len(text) if first is None else first.start()
        return f"{text[:at].rstrip()}\n{_keys_text(section)}\n{text[at:].lstrip()}"
    head = re.search(rf"^[ \t]*\[[ \t]*{re.escape(section.table)}[ \t]*\][^\n]*\n?", text,
                     re.MULTILINE)  # fmt: skip
    if not is_there or head is None:
        return text.rstrip("\n") + "\n" + section_text(section)
    return f"{text[: head.end()].rstrip()}\n{_keys_text(section)}{text[head.end() :]}"
