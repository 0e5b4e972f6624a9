"""The text of a machine file with other tables, or with reflectors that stood elsewhere."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import InlineTable

from vmach.errors import InputError
from vmach.files.text_file import read_text
from vmach.files.toml_file import line_of_key
from vmach.history.following_job import moved_path
from vmach.machine.component_errors import component_of
from vmach.machine.files.volumetric_file import read_volumetric_file

__all__ = ["MachineValue", "other_machine_text"]

#: keys of a table that stay with its error whatever file it is in
_OF_SET_UP = ("measured_at_mm", "nose_at_mm", "stick_out_mm", "set_up", "slope_removed",
              "extrapolation")  # fmt: skip


@dataclass(frozen=True)
class MachineValue:
    """Another table of a component error, or another place of its reflector.

    Attributes
    ----------
    component : str
        ``EXX``.
    table : Path, optional
        CSV file over machine coordinates.
    place_mm : (3,) of float, optional
        In the frame of the body that the axis carries.
    """

    component: str
    table: Path | None = None
    place_mm: tuple[float, ...] | None = None

    @property
    def words(self) -> str:
        """For people."""
        if self.table is not None:
            return f"table {self.component}"
        return f"reflector of {self.component}"


def other_machine_text(machine: Path, values: Sequence[MachineValue], folder: Path) -> str:
    """The text of a machine file in a folder, with other values.

    Raises
    ------
    InputError
        A reflector without a table; a volumetric file that cannot be read.
    """
    document = _with_error_tables(read_text(machine, what="machine file"), machine)
    entries = document.setdefault("errors", tomlkit.table(is_super_table=True))
    for entry in entries.values():
        if "table" in entry:
            entry["table"] = moved_path(str(entry["table"]), machine.parent, folder)
    if "volumetric" in document:
        _make_room(document["volumetric"], entries, values, machine)
        document["volumetric"]["file"] = moved_path(
            str(document["volumetric"]["file"]), machine.parent, folder
        )
    for value in values:
        _set(entries, value, machine, folder)
    text = tomlkit.dumps(document)
    try:
        tomllib.loads(text)
    except ValueError:
        line = line_of_key(read_text(machine, what="machine file"), ["errors"])
        raise InputError(
            "the file cannot be changed as it is written", file=machine, line=line,
            accepted="a table [errors.NAME] for each error",
        ) from None  # fmt: skip
    return text


def _with_error_tables(text: str, machine: Path) -> Any:
    """A machine's data with its comments; errors that are written inline get tables of their own.

    Raises
    ------
    InputError
        It is written in a way that cannot be changed.
    """
    try:
        document: Any = tomlkit.parse(text)
    except TOMLKitError as error:
        raise InputError(
            f"the file cannot be changed: {error}", file=machine, accepted="TOML"
        ) from None
    entries = document.get("errors", {})
    if any(isinstance(table, InlineTable) for table in (entries, *entries.values())):
        said = document.pop("errors").unwrap()
        plain = tomlkit.table(is_super_table=True)
        for name, entry in said.items():
            plain[name] = entry
        document["errors"] = plain
    return document


def _make_room(
    volumetric: Any, entries: Any, values: Sequence[MachineValue], machine: Path
) -> None:
    """Leave errors out of a volumetric file that get a table, and keep where they were read."""
    found = read_volumetric_file(machine.parent / volumetric["file"], volumetric["format"])
    without = list(volumetric.get("without", ()))
    for value in values:
        name = value.component
        if name not in found.tables or name in without:
            continue
        entry = entries.setdefault(name, tomlkit.table())
        keys = ("measured_at_mm", "nose_at_mm", "stick_out_mm")
        if not component_of(name)[2] and not any(key in entry for key in keys):
            entry["measured_at_mm"] = volumetric["measured_at_mm"].unwrap()
        if value.table is not None:
            without.append(name)
            volumetric["without"] = without


def _set(entries: Any, value: MachineValue, machine: Path, folder: Path) -> None:
    name, old = value.component, entries.get(value.component)
    if value.table is not None:
        entries[name] = _with_table(old, value, folder)
    elif old is None:
        raise InputError(f"{name} has no table", file=machine, hint=f"set {name}=TABLE.csv, too")
    if value.place_mm is not None:
        for key in ("nose_at_mm", "stick_out_mm"):
            entries[name].pop(key, None)
        entries[name]["measured_at_mm"] = list(value.place_mm)


def _with_table(old: Any, value: MachineValue, folder: Path) -> Any:
    """An entry for a table that runs straight between its positions, in the set-up of before.

    A displacement that had no table is taken to be read at the frame's origin.
    """
    assert value.table is not None
    entry = tomlkit.table()
    entry["table"] = moved_path(value.table.as_posix(), Path(), folder)
    entry["interpolation"] = "linear"
    entry["provenance"] = "assumed"
    for key in _OF_SET_UP:
        if old is not None and key in old:
            entry[key] = old[key].unwrap()
    if old is None and not component_of(value.component)[2]:
        entry["measured_at_mm"] = [0.0, 0.0, 0.0]
    return entry
