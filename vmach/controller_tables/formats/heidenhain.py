"""HEIDENHAIN nonlinear axis-error compensation: ``*.COM`` tables, assigned in ``CONFIG.CMA``.

Followed here is the table format of the controls with CfgAxes (described in the MANUALplus 620
Technical Manual, "Compensation-value tables"): a ``.COM`` table has the position of one axis in
AXISPOS and, in a column named after each axis that depends on it, what was measured there; values
measured in negative direction go to BACKLASH. In the ``.CMA`` table the column of an axis names
the ``.COM`` whose positions are that axis': [axis in the column of the .COM] = F(axis in the
column of the .CMA). The line with ``*`` under ACTIVE is in force. At most 256 entries a table
(TNC 407 Technical Manual, module 9095, error 3).

Entries are errors, actual minus nominal, as measured (TNC 407 manual: the error is positive where
the travel is too long); the control subtracts them.

Source: HEIDENHAIN, MANUALplus 620 Technical Manual and TNC 407 Technical Manual.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vmach.controller_tables.knots import Knots
from vmach.controller_tables.projection import AxisTable, Term
from vmach.controller_tables.table_format import HeldErrors, TableFormat, error_name, projected
from vmach.controller_tables.table_task import TableTask
from vmach.errors import InputError
from vmach.files.text_file import decimal_number, read_text

__all__ = [
    "FORMATS",
    "MOST_ENTRIES",
    "AxisErrorCompensation",
    "read_heidenhain",
    "write_heidenhain",
]

MOST_ENTRIES = 256
_AXES = "XYZ"


def write_heidenhain(folder: Path, tables: Sequence[AxisTable]) -> list[Path]:
    """Write ``CONFIG.CMA`` and one ``.COM`` for each axis whose position is looked up."""
    written, assigned = [], {}
    for axis, name in enumerate(_AXES):
        mine = {t.term.output_axis: t for t in tables if t.term.input_axis == axis}
        if mine:
            assigned[name] = f"{name}ERR.COM"
            written.append(_write_com(folder / assigned[name], axis, mine))
    row = ["0", "*", *(assigned.get(name, "-") for name in _AXES)]
    lines = ["BEGIN CONFIG.CMA", "NR ACTIVE X Y Z", " ".join(row), "[END]"]
    (folder / "CONFIG.CMA").write_text("\n".join(lines) + "\n", encoding="utf-8")
    return [folder / "CONFIG.CMA", *written]


def _write_com(path: Path, axis: int, tables: dict[int, AxisTable]) -> Path:
    own = tables.get(axis)
    columns = {"AXISPOS": [f"{q:.4f}" for q in next(iter(tables.values())).position_mm]}
    if own is not None and own.term.by_direction:
        columns["BACKLASH"] = _errors(own.backward_mm)
    for output, table in sorted(tables.items()):
        columns[_AXES[output]] = _errors(table.forward_mm)
    rows = zip(*columns.values(), strict=True)
    lines = [f"BEGIN {path.name} MM", " ".join(["NR", *columns])]
    lines += [" ".join([str(number), *row]) for number, row in enumerate(rows)]
    path.write_text("\n".join([*lines, "[END]"]) + "\n", encoding="utf-8")
    return path


def _errors(correction_mm: np.ndarray) -> list[str]:
    return [f"{round(-value, 6) + 0.0:.6f}" for value in correction_mm]


@dataclass(frozen=True)
class AxisErrorCompensation:
    """The active line of the assignment: columns of the ``.COM`` of each input axis."""

    tables: dict[int, dict[str, np.ndarray]]

    def applied_correction(
        self, nose_mm: np.ndarray, direction: np.ndarray, tool_mm: np.ndarray
    ) -> np.ndarray:
        """How far the axes are moved, (P, 3) mm; unknown directions take the mean."""
        found = np.zeros_like(nose_mm)
        for axis, columns in self.tables.items():
            at = nose_mm[:, axis]
            for name in columns.keys() & set(_AXES):
                output = _AXES.index(name)
                error = np.interp(at, columns["AXISPOS"], columns[name])
                if output == axis and "BACKLASH" in columns:
                    back = np.interp(at, columns["AXISPOS"], columns["BACKLASH"])
                    share = 0.5 * (1.0 - np.sign(direction[:, axis]))
                    error = error + share * (back - error)
                found[:, output] -= error
        return found


def read_heidenhain(folder: Path) -> AxisErrorCompensation:
    """Read the active line of ``CONFIG.CMA`` and the tables that it names.

    Raises
    ------
    InputError
        A row that does not fit its head, a table in inches, no active line, positions that do not
        increase, BACKLASH without the errors of the own axis.
    """
    path = folder / "CONFIG.CMA"
    head, rows = _table(path)
    active = [row for row in rows if row.cells[head.index("ACTIVE")] == "*"]
    if len(active) != 1:
        line = active[1].line if active else 2
        raise InputError(
            f"{len(active)} active lines", file=path, line=line, accepted="one line with *"
        )
    names = {axis: active[0].cells[head.index(axis)] for axis in _AXES if axis in head}
    tables = {}
    for axis, name in names.items():
        if name == "-":
            continue
        columns = tables[_AXES.index(axis)] = _com(folder / name)
        if "BACKLASH" in columns and axis not in columns:
            raise InputError(
                f"BACKLASH without a column {axis}", file=folder / name, line=2,
                accepted=f"both: {axis} is the error of this axis in positive direction, BACKLASH "
                "in negative direction",
            )  # fmt: skip
    return AxisErrorCompensation(tables)


@dataclass(frozen=True)
class _Row:
    """Words of a line that is not empty, and its number in the file, 1-based."""

    line: int
    cells: list[str]


def _table(path: Path) -> tuple[list[str], list[_Row]]:
    text = read_text(path, what="table").splitlines()
    lines = [_Row(k, line.split()) for k, line in enumerate(text, 1) if line.strip()]
    if len(lines) < 3 or lines[0].cells[0] != "BEGIN" or lines[-1].cells != ["[END]"]:
        begins, ends = (" ".join(lines[k].cells) if lines else "" for k in (0, -1))
        raise InputError(
            f"no table: it begins with {begins!r} and ends with {ends!r}",
            file=path,
            line=1,
            accepted="BEGIN ..., column names, rows, [END]",
        )
    if "INCH" in lines[0].cells[2:]:
        begins = " ".join(lines[0].cells)
        raise InputError(f"'{begins}'", file=path, line=lines[0].line, accepted="a table in MM")
    head = lines[1].cells
    for row in lines[2:-1]:
        if len(row.cells) != len(head):
            raise InputError(
                f"{len(row.cells)} cells", file=path, line=row.line,
                accepted=f"{len(head)} as in the head",
            )  # fmt: skip
    return head, lines[2:-1]


def _com(path: Path) -> dict[str, np.ndarray]:
    head, rows = _table(path)
    values = np.array([[decimal_number(cell) for cell in row.cells] for row in rows])
    for row, numbers in zip(rows, values, strict=True):
        if np.isnan(numbers).any():
            said = f"'{row.cells[int(np.argmax(np.isnan(numbers)))]}' is no number"
            raise InputError(said, file=path, line=row.line, accepted="decimal numbers")
    columns = {name: values[:, k] for k, name in enumerate(head) if name != "NR"}
    falls = np.diff(columns["AXISPOS"]) <= 0
    if len(rows) > MOST_ENTRIES or falls.any():
        line = rows[int(np.argmax(falls)) + 1 if falls.any() else MOST_ENTRIES].line
        raise InputError(
            f"{len(rows)} entries", file=path, line=line,
            accepted=f"at most {MOST_ENTRIES}, AXISPOS increasing",
        )  # fmt: skip
    return columns


def errors_of_heidenhain(folder: Path, options: Mapping[str, Any]) -> HeldErrors:
    """The entries, which are errors as measured; reversal of the own axis alone."""
    tables = {}
    for axis, columns in read_heidenhain(folder).tables.items():
        for name in columns.keys() & set(_AXES):
            output = _AXES.index(name)
            back = columns.get("BACKLASH", columns[name]) if output == axis else columns[name]
            tables[error_name(output, axis)] = (columns["AXISPOS"], columns[name], back)
    return HeldErrors(dict(sorted(tables.items())))


def _cross_own_reversal(task: TableTask) -> list[Term]:
    return [Term(j, i, task.by_direction and i == j) for i in range(3) for j in range(3)]


def _write(
    folder: Path, task: TableTask, knots: tuple[Knots, Knots, Knots], options: Mapping[str, Any]
) -> list[Path]:
    return write_heidenhain(folder, projected(task, _cross_own_reversal(task), knots)[1])


FORMATS = (
    TableFormat(
        name="heidenhain",
        rank=30,
        title="HEIDENHAIN nonlinear axis-error compensation (.COM, .CMA)",
        holds="positioning with reversal, "
        "straightness and squareness by the position of one axis each",
        lacks="reversal across, angles (their mean at one tool length is in), tool length, tilt",
        most_entries=MOST_ENTRIES,
        write=_write,
        read=lambda folder, options: read_heidenhain(folder),
        terms=_cross_own_reversal,
        errors=errors_of_heidenhain,
        sign="CONFIG.CMA",
    ),
)
