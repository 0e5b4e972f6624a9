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
from vmach.files.text_file import read_text

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
        A row that does not fit its head, no active line, positions that do not increase.
    """
    path = folder / "CONFIG.CMA"
    head, rows = _table(path)
    active = [row for row in rows if row[head.index("ACTIVE")] == "*"]
    if len(active) != 1:
        raise InputError(f"{len(active)} active lines", file=path, accepted="one line with *")
    names = {axis: active[0][head.index(axis)] for axis in _AXES if axis in head}
    return AxisErrorCompensation(
        {_AXES.index(axis): _com(folder / name) for axis, name in names.items() if name != "-"}
    )


def _table(path: Path) -> tuple[list[str], list[list[str]]]:
    lines = [line.split() for line in read_text(path, what="table").splitlines() if line.strip()]
    if len(lines) < 3 or lines[0][0] != "BEGIN" or lines[-1] != ["[END]"]:
        begins, ends = (" ".join(lines[k]) if lines else "" for k in (0, -1))
        raise InputError(
            f"no table: it begins with {begins!r} and ends with {ends!r}",
            file=path,
            accepted="BEGIN ..., column names, rows, [END]",
        )
    head = lines[1]
    for number, row in enumerate(lines[2:-1], 3):
        if len(row) != len(head):
            raise InputError(
                f"{len(row)} cells", file=path, line=number, accepted=f"{len(head)} as in the head"
            )
    return head, lines[2:-1]


def _com(path: Path) -> dict[str, np.ndarray]:
    head, rows = _table(path)
    try:
        values = np.array(rows, dtype=float)
    except ValueError as error:
        raise InputError(f"a cell is no number: {error}", file=path) from None
    columns = {name: values[:, k] for k, name in enumerate(head) if name != "NR"}
    if len(rows) > MOST_ENTRIES or np.any(np.diff(columns["AXISPOS"]) <= 0):
        raise InputError(
            f"{len(rows)} entries", file=path,
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
