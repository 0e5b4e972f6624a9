"""A table as instruments write it: any separator, decimal comma, units in the heading.

The heading is the first line that names the columns that are asked for. Lines above it are the
instrument's own head. Every line below it is a row, or the file is refused with its number.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from vmach.files.text_file import decimal_number
from vmach.importers.source_file import SourceFile
from vmach.importers.time_of_day import CLOCK, is_time_of_day, seconds_of_day
from vmach.machine.tables.error_table import MM_PER, RAD_PER

__all__ = ["ANGLE", "LENGTH", "NUMBER", "SMALL", "SMALL_ANGLE", "SMALL_LENGTH", "SPEED", "TIME",
           "Column", "LooseTable", "cells"]  # fmt: skip

#: sizes of units in the unit of the project's own files: mm; um or urad; degrees; s; 1/min
LENGTH = {**MM_PER, "in": 25.4, "inches": 25.4}
SMALL_LENGTH = {unit: size * 1e3 for unit, size in LENGTH.items()} | {"nm": 1e-3}
SMALL_ANGLE = {unit: size * 1e6 for unit, size in RAD_PER.items()} | {
    "sec": 1e6 * RAD_PER["arcsec"]
}
SMALL = SMALL_LENGTH | SMALL_ANGLE
ANGLE = {"deg": 1.0, "degree": 1.0, "degrees": 1.0, "rad": 57.29577951308232, "°": 1.0}
TIME = {"s": 1.0, "sec": 1.0, "min": 60.0, "h": 3600.0, "ms": 1e-3}
SPEED = {"rpm": 1.0, "1/min": 1.0, "mm/min": 1.0, "mm/s": 60.0, "in/min": 25.4, "m/min": 1e3}
NUMBER = None

_UNIT_HINT = "--set unit=mm for lengths, or write the unit into the heading: 'Deviation (um)'"
_TIME_HINT = "write the unit into the heading: 'Time (min)'; times of day are 08:59:30"
#: of units
_OTHER_NAMES = {
    '"': "arcsec",
    "micron": "um",
    "microns": "um",
    "uinch": "uin",
    "microinch": "uin",
    "mm/m": "mrad",
}
_SEPARATORS = (";", "\t", ",", "|", None)
_UNIT = re.compile(r"[\s_/]*[\[(/_ ]\s*([a-zµμ°\"/0-9]+)\s*[\])]?\s*$")
#: lines that are looked at for a heading
_HEAD_LINES = 200
_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")


@dataclass(frozen=True)
class Column:
    """A column that is looked for.

    Attributes
    ----------
    name : str
        What the importer calls it.
    words : tuple of str
        How headings call it, in lower case, without the unit. A `*` at the end stands for more.
    units : mapping
        Sizes of the units that it can have; None for a number without unit.
    unit : str
        Of a heading that names none.
    is_needed : bool
    is_text : bool
    """

    name: str
    words: tuple[str, ...]
    units: Mapping[str, float] | None = NUMBER
    unit: str = ""
    is_needed: bool = True
    is_text: bool = False

    def matches(self, word: str) -> bool:
        """Whether a heading is this column's."""
        return any(
            word.startswith(own[:-1]) if own.endswith("*") else word == own for own in self.words
        )


@dataclass(frozen=True)
class LooseTable:
    """Rows of a table.

    Attributes
    ----------
    source : SourceFile
    header : tuple of str
        Headings as they stand in the file.
    header_line : int
    lines : (P,) int64
        Line of each row.
    numbers : mapping of str to (P,) float64
        In the units of the project's own files; NaN for an empty cell.
    text : mapping of str to (P,) str
    units : mapping of str to str
        What the file has each column of `numbers` in; empty for a number without unit. A column
        of times may hold times of day: seconds count from the first.
    """

    source: SourceFile
    header: tuple[str, ...]
    header_line: int
    lines: np.ndarray
    numbers: Mapping[str, np.ndarray]
    text: Mapping[str, np.ndarray]
    units: Mapping[str, str]

    @classmethod
    def find(
        cls,
        source: SourceFile,
        columns: Sequence[Column],
        *,
        given: Mapping[str, str] | None = None,
    ) -> LooseTable | None:
        """The table with these columns, or None where no line names them all.

        Parameters
        ----------
        source : SourceFile
        columns : sequence of Column
        given : mapping, optional
            The file's own heading of a column, by the importer's name for it.

        Raises
        ------
        InputError
            Two columns that may be meant, or a row that does not fit below the heading.
        """
        if not source.is_text:
            return None
        for number, line in enumerate(source.lines[:_HEAD_LINES]):
            for separator in _SEPARATORS:
                header = cells(line, separator)
                found = _found(header, columns, given or {})
                if found is not None:
                    _check_once(source, number + 1, header, found, given or {})
                    return cls._read(source, number, separator, header, found)
        return None

    @classmethod
    def _read(
        cls,
        source: SourceFile,
        head: int,
        separator: str | None,
        header: list[str],
        found: Mapping[int, tuple[Column, str]],
    ) -> LooseTable:
        rows, lines = [], []
        for number, line in enumerate(source.lines[head + 1 :], head + 2):
            row = cells(line, separator)
            if not any(row) or line.lstrip().startswith("#"):
                continue
            if number == head + 2 and _is_row_of_units(row, found):
                found = {
                    k: (column, _plain_unit(row[k]) or unit) for k, (column, unit) in found.items()
                }
                continue
            if len(row) != len(header) and not (
                len(row) > len(header) and not any(row[len(header) :])
            ):
                raise source.error(
                    f"{len(row)} cells",
                    line=number,
                    accepted=f"{len(header)} as in line {head + 1}",
                )
            rows.append(row)
            lines.append(number)
        if not rows:
            raise source.error(
                "no rows below the heading", line=head + 1, accepted="rows of numbers"
            )
        clocks = [k for k, (column, _) in found.items() if column.units is TIME and
                  all(is_time_of_day(row[k]) for row in rows)]  # fmt: skip
        _check_marks(source, rows, lines, [k for k, (column, _) in found.items()
                                           if not column.is_text and k not in clocks])  # fmt: skip
        numbers, text, units = {}, {}, {}
        for k, (column, unit) in found.items():
            own = [row[k] for row in rows]
            if column.is_text:
                text[column.name] = np.array(own)
            elif k in clocks:
                numbers[column.name] = seconds_of_day(own)
                units[column.name] = CLOCK
            else:
                size = _size(source, column, unit, header[k], head + 1)
                numbers[column.name] = size * _values(source, own, lines, header[k])
                units[column.name] = unit or column.unit
        return cls(source, tuple(header), head + 1, np.array(lines), numbers, text, units)

    def complete(self, name: str) -> np.ndarray:
        """A column without empty cells, (P,).

        Raises
        ------
        InputError
            With the line of the first that is empty.
        """
        values = self.numbers[name]
        empty = np.isnan(values)
        if empty.any():
            line = int(self.lines[np.argmax(empty)])
            raise self.source.error(f"no {name} in this row", line=line, accepted="a number")
        return values


def cells(line: str, separator: str | None) -> list[str]:
    """Cells of a line, without blanks and quotation marks; no separator means blanks."""
    if separator is None:
        return line.split()
    try:
        found = next(csv.reader([line], delimiter=separator), [])
    except csv.Error:
        return []
    return [cell.strip() for cell in found]


def _found(
    header: list[str], columns: Sequence[Column], given: Mapping[str, str]
) -> dict[int, tuple[Column, str]] | None:
    """Place of each column in a heading, and its unit; None where one is missing."""
    found: dict[int, tuple[Column, str]] = {}
    for column in columns:
        places = [k for k in _places(header, column, given) if k not in found]
        if not places and (column.is_needed or column.name in given):
            return None
        if places:
            found[places[0]] = (column, _split(header[places[0]], column)[1])
    return found if len(found) > 1 else None


def _places(header: list[str], column: Column, given: Mapping[str, str]) -> list[int]:
    """Where a heading has a column: as told, else by its words."""
    if column.name in given:
        own = given[column.name].strip().lower()
        return [k for k, cell in enumerate(header) if cell.lower() == own]
    return [k for k, cell in enumerate(header) if column.matches(_split(cell, column)[0])]


def _check_once(
    source: SourceFile,
    line: int,
    header: list[str],
    found: Mapping[int, tuple[Column, str]],
    given: Mapping[str, str],
) -> None:
    """Refuse numbers that two columns may hold: one of them would be left out in silence."""
    for place, (column, _) in found.items():
        others = [k for k in _places(header, column, given) if k not in found]
        if others and not column.is_text:
            raise source.error(
                f"columns {place + 1} and {others[0] + 1}, '{header[place]}' and "
                f"'{header[others[0]]}', may both be {column.name}",
                line=line,
                accepted=f"one column of {column.name}",
                hint=f"--column {column.name}='HEADING' says which; runs side by side have "
                "numbers: 'Run 1 +', 'Run 1 -', 'Run 2 +'",
            )


def _check_marks(
    source: SourceFile, rows: Sequence[list[str]], lines: Sequence[int], places: Sequence[int]
) -> None:
    """Refuse a table with decimal points and commas: one of them groups thousands."""
    numbers = [(row[k], line) for row, line in zip(rows, lines, strict=True) for k in places]
    point = next((cell for cell, _ in numbers if "." in cell), None)
    comma = next(((cell, line) for cell, line in numbers if _COMMA.fullmatch(cell)), None)
    if point is not None and comma is not None:
        raise source.error(
            f"'{comma[0]}' has a comma, '{point}' a point",
            line=comma[1],
            accepted="one decimal mark in the whole table, and no mark between thousands",
        )


def _split(cell: str, column: Column) -> tuple[str, str]:
    """Word and unit of a heading; the unit is left in where it is none of this column."""
    text = cell.strip().strip('"').lower().replace("µ", "u").replace("μ", "u")
    unit = _UNIT.search(text)
    if unit and _plain_unit(unit[1]) in (column.units or ()):
        return _plain_word(text[: unit.start()]), _plain_unit(unit[1])
    return _plain_word(text), ""


def _plain_word(text: str) -> str:
    return re.sub(r"[\s_:]+", " ", text).strip(" .")


def _plain_unit(text: str) -> str:
    text = text.strip("[]() ").lower().replace("µ", "u").replace("μ", "u")
    return _OTHER_NAMES.get(text, text)


def _is_row_of_units(row: list[str], found: Mapping[int, tuple[Column, str]]) -> bool:
    """Whether the line below the heading has units where the columns have them."""
    own = [
        _plain_unit(row[k]) in column.units
        for k, (column, _) in found.items()
        if column.units and k < len(row)
    ]
    return bool(own) and all(own)


def _size(source: SourceFile, column: Column, unit: str, heading: str, line: int) -> float:
    if not column.units:
        return 1.0
    unit = unit or column.unit
    if unit not in column.units:
        raise source.error(
            f"the heading '{heading}' names no unit",
            line=line,
            accepted=", ".join(column.units),
            hint=_TIME_HINT if column.units is TIME else _UNIT_HINT,
        )
    return column.units[unit]


def _values(
    source: SourceFile, own: Sequence[str], lines: Sequence[int], heading: str
) -> np.ndarray:
    values = np.empty(len(own))
    for k, cell in enumerate(own):
        plain = cell.replace(",", ".") if _COMMA.fullmatch(cell) else cell
        values[k] = decimal_number(plain.replace("−", "-"))
        if (cell and not np.isfinite(values[k])) or abs(values[k]) > 1e9:
            raise source.error(
                f"{heading} is '{cell}'", line=lines[k], accepted="a number such as -1.25 or -1,25"
            )
    return values
