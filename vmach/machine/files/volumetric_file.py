"""Reading all errors of a machine from one file of a control or a multilateration system.

* ``isg-csv``: the tables of the ISG kernel and of Beckhoff TwinCAT CNC (TF5280): a header
  ``X EXX EYX EZX EAX EBX ECX``, one row a position, ``//`` comments, ``#`` before a new header;
  squareness as a header without an axis.
* ``etalon``: the ETALON exchange text: blocks ``[EXY]`` with ``Gridpoints = { position value }``
  and ``[C0Y]`` with ``VALUE = ``.

Both state lengths in mm and angles in rad, one direction only.

Source: Beckhoff/ISG "Volumetric compensation" (FCT-C26), ISG CSV format; ETALON: the exchange
text as its files show it.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from vmach.errors import InputError
from vmach.files.text_file import decimal_number, read_text
from vmach.machine.component_errors import COMPONENT_NAMES, component_of
from vmach.machine.tables.error_table import LARGEST_MM, LARGEST_RAD

__all__ = ["FORMATS", "VolumetricFile", "read_volumetric_file"]

#: no two axes lean by more than six degrees; the number is in another unit
_LARGEST_SQUARENESS_RAD = 0.1
_SQUARENESS = re.compile(r"E?([ABC]0[XYZ])")


@dataclass
class VolumetricFile:
    """Tables and squareness found in one file.

    Attributes
    ----------
    tables : dict of ISO 230-1 symbol to (position_mm, value)
        Sorted by position; values in mm or rad.
    squareness_rad : dict of ``EC0Y`` ... to float
    """

    tables: dict[str, tuple[np.ndarray, np.ndarray]] = field(default_factory=dict)
    squareness_rad: dict[str, float] = field(default_factory=dict)


def read_volumetric_file(
    path: Path, format_name: str, *, text: str | None = None
) -> VolumetricFile:
    """Read a volumetric compensation file.

    Parameters
    ----------
    path : Path
    format_name : str
        A key of `FORMATS`.
    text : str, optional
        Of the file, where its encoding was looked at already; else it is UTF-8.

    Raises
    ------
    InputError
        No such file, a name that is no component error or squareness, a row that does not fit,
        a dependence on more than the axis' own position.
    """
    if text is None:
        text = read_text(path, what="volumetric file")
    found = VolumetricFile()
    for name, line, pairs in FORMATS[format_name](path, text):
        _store(found, path, line, name=name, pairs=pairs)
    if not found.tables and not found.squareness_rad:
        raise InputError(
            f"no error found in the volumetric file, read as format '{format_name}'", file=path,
            accepted=", ".join(FORMATS),
        )  # fmt: skip
    return found


Entry = tuple[str, int, list[tuple[float, float]]]  #: name, line, (position or NaN, value)


def _store(
    found: VolumetricFile, path: Path, line: int, *, name: str,
    pairs: list[tuple[float, float]],
) -> None:  # fmt: skip
    square = _SQUARENESS.fullmatch(name)
    if square and len(pairs) == 1:
        _check_size(name, pairs, (_LARGEST_SQUARENESS_RAD, "rad"), path, line)
        found.squareness_rad[f"E{square[1]}"] = pairs[0][1]
        return
    if name not in COMPONENT_NAMES:
        raise InputError(
            f"'{name}' is no error of a linear axis", file=path, line=line,
            accepted=", ".join(COMPONENT_NAMES) + ", C0Y and the like",
        )  # fmt: skip
    table = np.array(sorted(pairs))
    if len(table) < 2 or not np.all(np.diff(table[:, 0]) > 0):
        raise InputError(
            f"{name} has {len(table)} rows or a position twice", file=path, line=line,
            accepted="two or more rows, each position once",
        )  # fmt: skip
    is_angle = component_of(name)[2]
    _check_size(name, pairs, (LARGEST_RAD, "rad") if is_angle else (LARGEST_MM, "mm"), path, line)
    if name in found.tables:
        raise InputError(f"{name} occurs twice", file=path, line=line)
    found.tables[name] = (table[:, 0], table[:, 1])


def _check_size(
    name: str, pairs: list[tuple[float, float]], limit: tuple[float, str], path: Path, line: int
) -> None:
    """Refuse what no machine has: such a number is in another unit."""
    most = max((abs(value) for _, value in pairs), default=0.0)
    if most > limit[0]:
        raise InputError(
            f"{name} holds {most:g} {limit[1]}", file=path, line=line,
            accepted=f"mm and rad; of {name} at most {limit[0]:g} {limit[1]}",
        )  # fmt: skip


def _lines(text: str) -> Iterator[tuple[int, str]]:
    """Lines that hold anything beside a comment, with their numbers."""
    for number, line in enumerate(text.splitlines(), 1):
        content = line.split("//")[0].strip()
        if content:
            yield number, content


def _isg_csv(path: Path, text: str) -> Iterator[Entry]:
    header: list[str] = []
    start, rows = 0, []
    for line, content in _lines(text):
        if content.startswith("#"):
            yield from _isg_block(path, start, header, rows)
            header, rows = [], []
        elif not header:
            header, start = _cells(content), line
        else:
            rows.append(_row(path, line, _cells(content), width=len(header)))
    yield from _isg_block(path, start, header, rows)


def _cells(content: str) -> list[str]:
    return re.split(r"[\s;,]+", content)


def _isg_block(
    path: Path, line: int, header: list[str], rows: list[list[float]]
) -> Iterator[Entry]:
    arguments = [name for name in header if name in "XYZABC"]
    if len(arguments) > 1:
        raise InputError(
            f"errors that depend on {' and '.join(arguments)} at once", file=path, line=line,
            accepted="tables over one axis",
        )  # fmt: skip
    for column, name in enumerate(header):
        if name in arguments:
            continue
        if arguments and name[-1] != arguments[0]:
            raise InputError(
                f"{name} over {arguments[0]}",
                file=path,
                line=line,
                accepted=f"errors of axis {arguments[0]}",
            )
        position = header.index(arguments[0]) if arguments else None
        yield (
            name,
            line,
            [(math.nan if position is None else row[position], row[column]) for row in rows],
        )


def _row(path: Path, line: int, cells: list[str], *, width: int) -> list[float]:
    numbers = [decimal_number(cell) for cell in cells]
    if len(numbers) != width or not all(map(math.isfinite, numbers)):
        raise InputError(
            f"row '{' '.join(cells)}'", file=path, line=line,
            accepted=f"{width} finite numbers",
        )  # fmt: skip
    return numbers


def _etalon(path: Path, text: str) -> Iterator[Entry]:
    name, start, pairs, inside = "", 0, [], False
    for line, content in _lines(text):
        block = re.fullmatch(r"\[(\w+)\]", content)
        value = re.fullmatch(r"VALUE\s*=\s*(\S+)", content, re.IGNORECASE)
        if block:
            name, start, pairs = block[1], line, []
        elif value and name:
            yield name, start, [(math.nan, _row(path, line, [value[1]], width=1)[0])]
        elif re.fullmatch(r"Gridpoints\s*=\s*\{", content, re.IGNORECASE) and name:
            inside = True
        elif content == "}" and inside:
            inside = False
            yield name, start, pairs
        elif inside:
            position, error = _row(path, line, _cells(content), width=2)
            pairs.append((position, error))
        else:
            raise InputError(
                f"'{content}'", file=path, line=line,
                accepted="[NAME], VALUE = number, Gridpoints = { ... }",
            )  # fmt: skip
    if inside:
        raise InputError(f"Gridpoints of {name} has no closing brace", file=path, line=start)


FORMATS: dict[str, Callable[[Path, str], Iterator[Entry]]] = {
    "isg-csv": _isg_csv,
    "etalon": _etalon,
}
