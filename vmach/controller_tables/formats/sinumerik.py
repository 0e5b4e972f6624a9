"""Siemens SINUMERIK: sag and angularity compensation (CEC), and encoder or leadscrew compensation.

Source: SINUMERIK 840D sl / 828D, Function Manual Extended Functions, K3 Compensations (03/2013),
interpolatory compensation:

* a CEC table has one base axis (input) and one compensation axis (output), entries
  ``$AN_CEC[t,N]`` at ``MIN + N STEP``, linear between, the ends held beyond;
* ``$AN_CEC_DIRECTION`` 0: both directions of the base axis, 1 or -1: only that one;
* ``$AN_CEC_MULT_BY_TABLE[t] = n``: the values of table t times those of table n (index n - 1) are
  *added* to what the tables themselves give. Tables that only serve a product are therefore taken
  out again by the plain tables of the same axes, entry by entry;
* ``$AA_ENC_COMP``: the axis' own position, no direction; a positive value moves the axis in
  negative direction.

Which way a positive CEC value moves the compensation axis, the pages of the manual that were at
hand do not say: the entries are corrections added to the setpoint, or errors where asked for.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from vmach.controller_tables.knots import Knots
from vmach.controller_tables.projection import AxisTable, Term, scaled
from vmach.controller_tables.table_format import HeldErrors, TableFormat, error_name, projected
from vmach.controller_tables.table_task import TableTask
from vmach.errors import InputError
from vmach.files.text_file import decimal_number, read_text

__all__ = [
    "FORMATS",
    "MOST_ENTRIES",
    "CrossCompensation",
    "EncoderCompensation",
    "read_cec",
    "read_enc_comp",
    "write_cec",
    "write_enc_comp",
]

#: of a table of SINUMERIK 828D and 808D; 840D sl takes more (MD18342, MD38000)
MOST_ENTRIES = 200
_AXES = ("X1", "Y1", "Z1")
_DIGITS = 6
_SMALLEST_FACTOR_MM = 1e-3
#: of any number of a table, mm
_LARGEST = 1e6
_CEC_HEAD = """%_N_NC_CEC_INI
CHANDATA(1)
; sag and angularity compensation; entries in mm: {entries}
; holds: an axis moved by the position of one axis (pitch, straightness, squareness), reversal,
; and products of two positions (angles at one tool length, tables with MULT_BY_TABLE)
; does not hold: other tool lengths, the tilt of the tool
; MD18342 $MN_MM_CEC_MAX_POINTS[t] >= entries of each table; MD10260/MD32711: metric
; check the sign with one table and one move before use
"""
_ENC_HEAD = """%_N_AX_EEC_INI
CHANDATA(1)
; encoder (leadscrew) compensation; entries in mm: error, actual minus nominal; a positive value
; moves the axis in negative direction
; holds: the axis' own position; no reversal, no straightness, no angle, no other axis
; MD38000 $MA_MM_ENC_COMP_MAX_POINTS >= entries
"""


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
    lines = [_CEC_HEAD.format(entries=meaning[entries])]
    for index, table in enumerate(made):
        lines += [f"$AN_CEC[{index},{k}]={v:.{_DIGITS}f}\n" for k, v in enumerate(table.value_mm)]
        times = 0 if table.times is None else made.index(table.times) + 1
        settings = {
            "INPUT_AXIS": f"({_AXES[table.input_axis]})",
            "OUTPUT_AXIS": f"({_AXES[table.output_axis]})",
            **_grid_settings(table.position_mm),
            "DIRECTION": table.direction,
            "MULT_BY_TABLE": times,
            "IS_MODULO": 0,
        }
        lines += [f"$AN_CEC_{name}[{index}]={value}\n" for name, value in settings.items()]
    path = folder / "NC_CEC.INI"
    path.write_text("".join(lines) + "M17\n", encoding="utf-8")
    return [path]


def write_enc_comp(folder: Path, tables: Sequence[AxisTable]) -> list[Path]:
    """Write ``AX_EEC.INI`` from own-axis tables."""
    lines = [_ENC_HEAD]
    for table in tables:
        axis = _AXES[table.term.input_axis]
        lines += [
            f"$AA_ENC_COMP[0,{k},{axis}]={_plain(-value):.{_DIGITS}f}\n"
            for k, value in enumerate(table.forward_mm)
        ]
        settings = _grid_settings(table.position_mm) | {"IS_MODULO": 0}
        lines += [f"$AA_ENC_COMP_{name}[0,{axis}]={value}\n" for name, value in settings.items()]
    path = folder / "AX_EEC.INI"
    path.write_text("".join(lines) + "M17\n", encoding="utf-8")
    return [path]


def _plain(value: float) -> float:
    return round(float(value), _DIGITS) + 0.0


def _grid_settings(position_mm: np.ndarray) -> dict[str, str]:
    step = (position_mm[-1] - position_mm[0]) / (len(position_mm) - 1)
    return {
        "STEP": f"{step:.4f}",
        "MIN": f"{position_mm[0]:.4f}",
        "MAX": f"{position_mm[-1]:.4f}",
    }


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
        value = np.round(size * scaled(knots[axis], position), _DIGITS)
        factors[output, axis] = (size, _Table(axis, output, position, value))
        _add(plain, axis, output, 0, knots, -value)
    for table in tables:
        term = table.term
        if term.factor_axis is not None:
            size, factor = factors[term.output_axis, term.factor_axis]
            value = np.round(sign * table.forward_mm / size, _DIGITS)
            products.append(
                _Table(term.input_axis, term.output_axis, table.position_mm, value, times=factor)
            )
            _add(plain, term.input_axis, term.output_axis, 0, knots, -value)
    for table in plain.values():
        table.value_mm = np.round(table.value_mm, _DIGITS) + 0.0
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


@dataclass
class _ReadTable:
    """One table as the control holds it."""

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
        return "XYZ".index(self.settings[name].strip("()")[0])


@dataclass(frozen=True)
class CrossCompensation:
    """The CEC tables of a control, by index."""

    tables: dict[int, _ReadTable]
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


@dataclass(frozen=True)
class EncoderCompensation:
    """The encoder compensation of a control, by axis index."""

    tables: dict[int, _ReadTable]

    def applied_correction(
        self, nose_mm: np.ndarray, direction: np.ndarray, tool_mm: np.ndarray
    ) -> np.ndarray:
        """How far the axes move, (P, 3) mm: against a positive value."""
        found = np.zeros_like(nose_mm)
        for axis, table in self.tables.items():
            found[:, axis] = -table.at(nose_mm[:, axis])
        return found


_CEC_LINE = re.compile(r"\$AN_CEC(?:_([A-Z_]+))?\[(\d+)(?:,(\d+))?\]\s*=\s*(\S+)")
_ENC_LINE = re.compile(r"\$AA_ENC_COMP(?:_([A-Z_]+))?\[0,(?:(\d+),)?([XYZ])\w*\]\s*=\s*(\S+)")


def read_cec(folder: Path, *, entries: str = "correction") -> CrossCompensation:
    """Read ``NC_CEC.INI``."""
    path = folder / "NC_CEC.INI"
    tables: dict[int, _ReadTable] = defaultdict(_ReadTable)
    for number, line in _program_lines(path):
        name, index, place, value = _matched(_CEC_LINE, line, path, number)
        _set(tables[int(index)], name, place, _value(name, value, path, number))
    _check(tables, path)
    return CrossCompensation(dict(tables), entries)


def read_enc_comp(folder: Path) -> EncoderCompensation:
    """Read ``AX_EEC.INI``."""
    path = folder / "AX_EEC.INI"
    tables: dict[int, _ReadTable] = defaultdict(_ReadTable)
    for number, line in _program_lines(path):
        name, place, axis, value = _matched(_ENC_LINE, line, path, number)
        _set(tables["XYZ".index(axis)], name, place, _value(name, value, path, number))
    _check(tables, path)
    return EncoderCompensation(dict(tables))


def _program_lines(path: Path):
    for number, line in enumerate(read_text(path, what="compensation file").splitlines(), 1):
        content = line.split(";")[0].strip()
        if content and not content.startswith(("%", "CHANDATA", "M17")):
            yield number, content


def _matched(pattern: re.Pattern, line: str, path: Path, number: int) -> tuple:
    found = pattern.fullmatch(line)
    if found is None:
        raise InputError(f"'{line}' is no line of a compensation table", file=path, line=number)
    return found.groups()


def _value(name: str | None, value: str, path: Path, line: int) -> str:
    """The value of a line; of an entry, and of what places the entries, a number."""
    if name in (None, "STEP", "MIN", "MAX") and not abs(decimal_number(value)) < _LARGEST:
        raise InputError(f"value '{value}'", file=path, line=line, accepted="a number in mm")
    return value


def _set(table: _ReadTable, name: str | None, place: str | None, value: str) -> None:
    if name is None:
        table.values[int(place)] = float(value)
    else:
        table.settings[name] = value


def _check(tables: dict[int, _ReadTable], path: Path) -> None:
    """MIN, MAX and STEP must agree with the entries that are there."""
    for index, table in tables.items():
        missing = {"STEP", "MIN", "MAX"} - set(table.settings)
        if missing:
            raise InputError(f"table {index} has no {', '.join(sorted(missing))}", file=path)
        low, high = float(table.settings["MIN"]), float(table.settings["MAX"])
        intervals = (high - low) / float(table.settings["STEP"])
        if abs(intervals - (len(table.values) - 1)) > 1e-6 or len(table.values) < 2:
            raise InputError(
                f"table {index} has {len(table.values)} entries for {low:g} .. {high:g} mm in "
                f"steps of {table.settings['STEP']} mm", file=path,
            )  # fmt: skip


def errors_of_enc(folder: Path, options: Mapping[str, Any]) -> HeldErrors:
    """The entries, which are errors; both directions alike."""
    tables = {}
    for axis, table in read_enc_comp(folder).tables.items():
        position = table.positions()
        tables[error_name(axis, axis)] = (position, table.at(position), table.at(position))
    return HeldErrors(tables)


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


def _own_axis_mean(task: TableTask) -> list[Term]:
    return [Term(k, k) for k in range(3)]


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


def _write_enc(
    folder: Path, task: TableTask, knots: tuple[Knots, Knots, Knots], options: Mapping[str, Any]
) -> list[Path]:
    return write_enc_comp(folder, projected(task, _own_axis_mean(task), knots)[1])


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
        name="sinumerik-enc",
        rank=20,
        title="SINUMERIK encoder (leadscrew) compensation ($AA_ENC_COMP)",
        holds="positioning of each axis by its own position, mean of both directions",
        lacks="reversal, straightness, squareness, angles, any other axis, tool length, tilt",
        most_entries=MOST_ENTRIES,
        write=_write_enc,
        read=lambda folder, options: read_enc_comp(folder),
        terms=_own_axis_mean,
        errors=errors_of_enc,
        sign="AX_EEC.INI",
    ),
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
