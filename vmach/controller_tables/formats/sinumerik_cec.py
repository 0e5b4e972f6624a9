"""Siemens SINUMERIK: sag and angularity compensation (CEC).

Source: SINUMERIK 840D sl / 828D, Function Manual Extended Functions, K3 Compensations (03/2013),
interpolatory compensation:

* a CEC table has one base axis (input) and one compensation axis (output), entries
  ``$AN_CEC[t,N]`` at ``MIN + N STEP``, linear between, the ends held beyond;
* ``$AN_CEC_DIRECTION`` 0: both directions of the base axis, 1 or -1: only that one;
* ``$AN_CEC_MULT_BY_TABLE[t] = n``: the values of table t times those of table n (index n - 1) are
  *added* to what the tables themselves give. Tables that only serve a product are therefore taken
  out again by the plain tables of the same axes, entry by entry.

Which way a positive CEC value moves the compensation axis, the pages of the manual that were at
hand do not say: the entries are corrections added to the setpoint, or errors where asked for.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vmach.controller_tables.knots import Knots
from vmach.controller_tables.projection import AxisTable, Term, scaled
from vmach.controller_tables.sinumerik_table import (
    AXES,
    DIGITS,
    MOST_ENTRIES,
    SinumerikTable,
    placing,
    read_tables,
)
from vmach.controller_tables.table_format import HeldErrors, TableFormat, error_name, projected
from vmach.controller_tables.table_task import TableTask
from vmach.errors import InputError

__all__ = ["FORMATS", "CrossCompensation", "read_cec", "write_cec"]

_SMALLEST_FACTOR_MM = 1e-3

_CEC_HEAD = """%_N_NC_CEC_INI
CHANDATA(1)
; sag and angularity compensation; entries in mm: {entries}
; holds: an axis moved by the position of one axis (pitch, straightness, squareness), reversal{more}
; does not hold: {lacks}
; MD18342 $MN_MM_CEC_MAX_POINTS[t] >= entries of each table; MD10260/MD32711: metric
; check the sign with one table and one move before use
"""

_CEC_LINE = re.compile(
    r"\$AN_CEC(?:_(?P<setting>[A-Z_]+))?"
    r"\[(?P<table>\d+)(?:,(?P<place>\d+))?\]\s*=\s*(?P<value>\S+)"
)


@dataclass(eq=False)  # each is itself: products find their factor among the tables
class _Table:
    """A CEC table on its way to the file."""

    input_axis: int
    output_axis: int
    position_mm: np.ndarray
    value_mm: np.ndarray
    direction: int = 0
    times: _Table | None = None


def write_cec(
    folder: Path,
    tables: Sequence[AxisTable],
    knots: tuple[Knots, Knots, Knots],
    *,
    entries: str = "correction",
) -> list[Path]:
    """Write ``NC_CEC.INI``.

    Parameters
    ----------
    folder : Path
    tables : sequence of AxisTable
        Corrections; those with a factor axis become products.
    knots : (Knots, Knots, Knots)
    entries : {"correction", "error"}
        What a positive entry is: added to the setpoint, or subtracted.
    """
    made = _cec_tables(tables, knots, sign=1.0 if entries == "correction" else -1.0)
    meaning = {"correction": "correction added to the setpoint", "error": "error, subtracted"}
    more, lacks = "", "angles beyond their mean, other tool lengths, the tilt of the tool"
    if any(table.times is not None for table in made):
        more = (
            ",\n; and products of two positions (angles at one tool length, "
            "tables with MULT_BY_TABLE)"
        )
        lacks = "other tool lengths, the tilt of the tool"
    lines = [_CEC_HEAD.format(entries=meaning[entries], more=more, lacks=lacks)]
    for index, table in enumerate(made):
        lines += [f"$AN_CEC[{index},{k}]={v:.{DIGITS}f}\n" for k, v in enumerate(table.value_mm)]
        times = 0 if table.times is None else made.index(table.times) + 1
        settings = {
            "INPUT_AXIS": f"({AXES[table.input_axis]})",
            "OUTPUT_AXIS": f"({AXES[table.output_axis]})",
            **placing(table.position_mm),
            "DIRECTION": table.direction,
            "MULT_BY_TABLE": times,
            "IS_MODULO": 0,
        }
        lines += [f"$AN_CEC_{name}[{index}]={value}\n" for name, value in settings.items()]
    path = folder / "NC_CEC.INI"
    path.write_text("".join(lines) + "M17\n", encoding="utf-8")
    return [path]


def _cec_tables(
    tables: Sequence[AxisTable], knots: tuple[Knots, Knots, Knots], *, sign: float
) -> list[_Table]:
    """Plain tables, factor tables and products; all values add up to what is asked for."""
    plain: dict[tuple[int, int, int], _Table] = {}
    largest: dict[tuple[int, int], float] = defaultdict(float)
    for table in tables:
        term = table.term
        if term.factor_axis is None:
            for way, value in _by_direction(table):
                _add(plain, term.input_axis, term.output_axis, way, knots, sign * value)
        else:
            key = (term.output_axis, term.factor_axis)
            largest[key] = max(largest[key], table.largest_mm)
    factors, products = {}, []
    for (output, axis), most in largest.items():
        size = max(round(float(np.sqrt(most)), 3), _SMALLEST_FACTOR_MM)
        position = knots[axis].position_mm
        value = np.round(size * scaled(knots[axis], position), DIGITS)
        factors[output, axis] = (size, _Table(axis, output, position, value))
        _add(plain, axis, output, 0, knots, -value)
    for table in tables:
        term = table.term
        if term.factor_axis is not None:
            size, factor = factors[term.output_axis, term.factor_axis]
            value = np.round(sign * table.forward_mm / size, DIGITS)
            products.append(
                _Table(term.input_axis, term.output_axis, table.position_mm, value, times=factor)
            )
            _add(plain, term.input_axis, term.output_axis, 0, knots, -value)
    for table in plain.values():
        table.value_mm = np.round(table.value_mm, DIGITS) + 0.0
    return [*plain.values(), *(factor for _, factor in factors.values()), *products]


def _by_direction(table: AxisTable) -> list[tuple[int, np.ndarray]]:
    if np.array_equal(table.forward_mm, table.backward_mm):
        return [(0, table.forward_mm)]
    return [(1, table.forward_mm), (-1, table.backward_mm)]


def _add(plain, axis: int, output: int, way: int, knots, value_mm: np.ndarray) -> None:
    """Add to the plain table of these axes and this direction; to both where it is for both."""
    ways = [way]
    if way == 0:
        ways = [k for k in (1, -1) if (axis, output, k) in plain] or [0]
    for one in ways:
        position = knots[axis].position_mm
        table = plain.setdefault(
            (axis, output, one), _Table(axis, output, position, np.zeros(len(position)), one)
        )
        table.value_mm = table.value_mm + value_mm


@dataclass(frozen=True)
class CrossCompensation:
    """The CEC tables of a control, by index."""

    tables: dict[int, SinumerikTable]
    entries: str = "correction"

    def applied_correction(
        self, nose_mm: np.ndarray, direction: np.ndarray, tool_mm: np.ndarray
    ) -> np.ndarray:
        """What is added to the setpoints, (P, 3) mm; unknown directions take the mean."""
        found = np.zeros_like(nose_mm)
        values = {k: self._value(k, nose_mm, direction) for k in self.tables}
        for index, table in self.tables.items():
            output = table.axis("OUTPUT_AXIS")
            found[:, output] += values[index]
            other = int(table.settings["MULT_BY_TABLE"])
            if other:
                found[:, output] += values[index] * values[other - 1]
        return found if self.entries == "correction" else -found

    def _value(self, index: int, nose_mm: np.ndarray, direction: np.ndarray) -> np.ndarray:
        table = self.tables[index]
        axis, way = table.axis("INPUT_AXIS"), int(table.settings["DIRECTION"])
        active = 1.0 if way == 0 else 0.5 * (1.0 + way * np.sign(direction[:, axis]))
        return active * table.at(nose_mm[:, axis])


def read_cec(folder: Path, *, entries: str = "correction") -> CrossCompensation:
    """Read ``NC_CEC.INI``."""
    tables = read_tables(folder / "NC_CEC.INI", _CEC_LINE)
    return CrossCompensation({int(index): table for index, table in tables.items()}, entries)


def errors_of_cec(folder: Path, options: Mapping[str, Any]) -> HeldErrors:
    """What the plain tables of each pair of axes take back, for either direction.

    Raises
    ------
    InputError
        Tables that are multiplied: no component error is a product of two positions.
    """
    found = _read_cec(folder, options)
    sign = -1.0 if found.entries == "correction" else 1.0
    pairs = defaultdict(list)
    for index, table in found.tables.items():
        if int(table.settings.get("MULT_BY_TABLE", 0)):
            raise InputError(
                f"table {index} is multiplied by another one",
                file=folder / "NC_CEC.INI",
                line=table.line,
                accepted="plain tables: products of two positions are no component error",
            )
        pairs[table.axis("OUTPUT_AXIS"), table.axis("INPUT_AXIS")].append(table)
    tables = {}
    for (output, axis), own in sorted(pairs.items()):
        position = np.unique(np.concatenate([table.positions() for table in own]))
        ways = [
            sum(t.at(position) for t in own if int(t.settings["DIRECTION"]) in (0, way))
            + np.zeros(len(position))
            for way in (1, -1)
        ]
        tables[error_name(output, axis)] = (position, sign * ways[0], sign * ways[1])
    return HeldErrors(tables)


def _cross(task: TableTask) -> list[Term]:
    return [Term(j, i, task.by_direction) for i in range(3) for j in range(3)]


def _cross_and_products(task: TableTask) -> list[Term]:
    products = [
        Term(j, i, factor_axis=k)
        for i in range(3)
        for j in range(3)
        for k in range(3)
        if k != j
    ]  # fmt: skip
    return _cross(task) + products


def _write_cec(
    folder: Path, task: TableTask, knots: tuple[Knots, Knots, Knots], options: Mapping[str, Any]
) -> list[Path]:
    tables = projected(task, _cross(task), knots)[1]
    return write_cec(folder, tables, knots, entries=_cec_entries(options))


def _write_cec_products(
    folder: Path, task: TableTask, knots: tuple[Knots, Knots, Knots], options: Mapping[str, Any]
) -> list[Path]:
    tables = projected(task, _cross_and_products(task), knots)[1]
    return write_cec(folder, tables, knots, entries=_cec_entries(options))


def _read_cec(folder: Path, options: Mapping[str, Any]) -> CrossCompensation:
    return read_cec(folder, entries=_cec_entries(options))


def _cec_entries(options: Mapping[str, Any]) -> str:
    return options.get("cec_entries", "correction")


FORMATS = (
    TableFormat(
        name="sinumerik-cec",
        rank=21,
        title="SINUMERIK sag and angularity compensation ($AN_CEC), plain tables",
        holds="positioning, "
        "straightness and squareness by the position of one axis each, with reversal",
        lacks="angles (their mean over the other axes at one tool length is in), tool length, tilt",
        most_entries=MOST_ENTRIES,
        write=_write_cec,
        read=_read_cec,
        terms=_cross,
        errors=errors_of_cec,
        sign="NC_CEC.INI",
    ),
    TableFormat(
        name="sinumerik-cec-products",
        rank=22,
        title="SINUMERIK sag and angularity compensation ($AN_CEC) with MULT_BY_TABLE",
        holds="as the plain tables, and angles times the position of another axis, "
        "at one tool length",
        lacks="reversal of angles, other tool lengths, tilt",
        most_entries=MOST_ENTRIES,
        write=_write_cec_products,
        read=_read_cec,
        terms=_cross_and_products,
    ),
)
