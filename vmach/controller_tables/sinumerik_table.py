"""The lines of a compensation table of SINUMERIK: entries at equal steps, and what places them.

Source: SINUMERIK 840D sl / 828D, Function Manual Extended Functions, K3 Compensations (03/2013).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from vmach.errors import InputError
from vmach.files.text_file import decimal_number, read_text

__all__ = ["AXES", "DIGITS", "MOST_ENTRIES", "SinumerikTable", "placing", "read_tables"]

#: of a table of SINUMERIK 828D and 808D; 840D sl takes more (MD18342, MD38000)
MOST_ENTRIES = 200
#: machine axes X, Y and Z
AXES = ("X1", "Y1", "Z1")
#: decimals of an entry in mm
DIGITS = 6
#: of any number of a table, mm
_LARGEST = 1e6
#: values of settings that are read; modulo tables belong to rotary axes
_ACCEPTED = {"DIRECTION": ("0", "1", "-1"), "IS_MODULO": ("0",)}
_AXIS_NAME = re.compile(r"\(?[XYZ]\w*\)?")


@dataclass
class SinumerikTable:
    """One compensation table as the control holds it."""

    #: where it begins in the file, 1-based
    line: int = 1
    values: dict[int, float] = field(default_factory=dict)
    settings: dict[str, str] = field(default_factory=dict)

    def at(self, position_mm: np.ndarray) -> np.ndarray:
        """Values of the table at positions, (P,) mm, as the control interpolates them, (P,)."""
        step, low = float(self.settings["STEP"]), float(self.settings["MIN"])
        count = round((float(self.settings["MAX"]) - low) / step) + 1
        entries = np.array([self.values.get(k, 0.0) for k in range(count)])
        place = np.clip((position_mm - low) / step, 0.0, count - 1)
        left = np.minimum(place.astype(int), count - 2)
        return entries[left] + (place - left) * (entries[left + 1] - entries[left])

    def positions(self) -> np.ndarray:
        """Where the entries are, (K,) mm."""
        low, high = float(self.settings["MIN"]), float(self.settings["MAX"])
        return np.linspace(low, high, len(self.values))

    def axis(self, name: str) -> int:
        """Number of the axis that a setting names."""
        return "XYZ".index(self.settings[name].strip("()")[0])


def placing(position_mm: np.ndarray) -> dict[str, str]:
    """The settings STEP, MIN and MAX of entries at positions (K,) mm, equally far apart."""
    step = (position_mm[-1] - position_mm[0]) / (len(position_mm) - 1)
    return {
        "STEP": f"{step:.4f}",
        "MIN": f"{position_mm[0]:.4f}",
        "MAX": f"{position_mm[-1]:.4f}",
    }


def read_tables(path: Path, pattern: re.Pattern) -> dict[str, SinumerikTable]:
    """The tables of a file.

    Parameters
    ----------
    path : Path
    pattern : re.Pattern
        Of a line, with the groups ``table``; ``setting``, or ``place`` of an entry; ``value``.

    Returns
    -------
    dict of str to SinumerikTable
        By the group ``table``.

    Raises
    ------
    InputError
        A line of another kind, no number, an entry twice, a modulo table, another axis than X, Y
        and Z, or entries that MIN, MAX and STEP do not place.
    """
    tables: dict[str, SinumerikTable] = {}
    for number, line in enumerate(read_text(path, what="compensation file").splitlines(), 1):
        content = line.split(";")[0].strip()
        if not content or content.startswith(("%", "CHANDATA", "M17")):
            continue
        found = pattern.fullmatch(content)
        if found is None:
            what = f"'{content}' is no line of a compensation table"
            raise InputError(what, file=path, line=number)
        name, value = found["setting"], found["value"]
        if name in (None, "STEP", "MIN", "MAX") and not abs(decimal_number(value)) < _LARGEST:
            raise InputError(f"value '{value}'", file=path, line=number, accepted="a number in mm")
        table = tables.setdefault(found["table"], SinumerikTable(number))
        if name is None:
            place = int(found["place"])
            if place in table.values:
                raise InputError(
                    f"entry {place} stands here a second time", file=path, line=number,
                    accepted="every entry once",
                )  # fmt: skip
            table.values[place] = float(value)
        else:
            if name in _ACCEPTED and value not in _ACCEPTED[name]:
                raise InputError(
                    f"{name} is {value}", file=path, line=number,
                    accepted=" or ".join(_ACCEPTED[name]),
                )  # fmt: skip
            if name in ("INPUT_AXIS", "OUTPUT_AXIS") and not _AXIS_NAME.fullmatch(value):
                raise InputError(
                    f"{name} is {value}", file=path, line=number,
                    accepted="an axis whose name begins with X, Y or Z, as (X1)",
                )  # fmt: skip
            table.settings[name] = value
    _check(tables, path)
    return dict(tables)


def _check(tables: dict[str, SinumerikTable], path: Path) -> None:
    """MIN, MAX and STEP must agree with the entries that are there."""
    for index, table in tables.items():
        missing = {"STEP", "MIN", "MAX"} - set(table.settings)
        if missing:
            raise InputError(
                f"table {index} has no {', '.join(sorted(missing))}", file=path, line=table.line
            )
        low, high = float(table.settings["MIN"]), float(table.settings["MAX"])
        if float(table.settings["STEP"]) <= 0.0:
            raise InputError(
                f"table {index} has STEP {table.settings['STEP']}", file=path, line=table.line,
                accepted="a step above 0 mm",
            )  # fmt: skip
        intervals = (high - low) / float(table.settings["STEP"])
        if abs(intervals - (len(table.values) - 1)) > 1e-6 or len(table.values) < 2:
            raise InputError(
                f"table {index} has {len(table.values)} entries for {low:g} .. {high:g} mm in "
                f"steps of {table.settings['STEP']} mm", file=path, line=table.line,
            )  # fmt: skip
        absent = sorted(set(range(len(table.values))) - set(table.values))
        if absent:
            raise InputError(
                f"table {index} has no entry {absent[0]}", file=path, line=table.line,
                accepted=f"entries 0 .. {len(table.values) - 1}", hint="the control counts from 0",
            )  # fmt: skip
