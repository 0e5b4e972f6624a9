"""Siemens SINUMERIK: encoder (leadscrew) compensation, ``$AA_ENC_COMP``.

Source: SINUMERIK 840D sl / 828D, Function Manual Extended Functions, K3 Compensations (03/2013):
the axis' own position, no direction; a positive value moves the axis in negative direction.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vmach.controller_tables.knots import Knots
from vmach.controller_tables.projection import AxisTable, Term
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

__all__ = ["FORMATS", "EncoderCompensation", "read_enc_comp", "write_enc_comp"]

_ENC_HEAD = """%_N_AX_EEC_INI
CHANDATA(1)
; encoder (leadscrew) compensation; entries in mm: error, actual minus nominal; a positive value
; moves the axis in negative direction
; holds: the axis' own position; no reversal, no straightness, no angle, no other axis
; MD38000 $MA_MM_ENC_COMP_MAX_POINTS >= entries
"""

_ENC_LINE = re.compile(
    r"\$AA_ENC_COMP(?:_(?P<setting>[A-Z_]+))?"
    r"\[0,(?:(?P<place>\d+),)?(?P<table>[XYZ])\w*\]\s*=\s*(?P<value>\S+)"
)


@dataclass(frozen=True)
class EncoderCompensation:
    """The encoder compensation of a control, by axis index."""

    tables: dict[int, SinumerikTable]

    def applied_correction(
        self, nose_mm: np.ndarray, direction: np.ndarray, tool_mm: np.ndarray
    ) -> np.ndarray:
        """How far the axes move, (P, 3) mm: against a positive value."""
        found = np.zeros_like(nose_mm)
        for axis, table in self.tables.items():
            found[:, axis] = -table.at(nose_mm[:, axis])
        return found


def write_enc_comp(folder: Path, tables: Sequence[AxisTable]) -> list[Path]:
    """Write ``AX_EEC.INI`` from own-axis tables."""
    lines = [_ENC_HEAD]
    for table in tables:
        axis = AXES[table.term.input_axis]
        lines += [
            f"$AA_ENC_COMP[0,{k},{axis}]={round(-value, DIGITS) + 0.0:.{DIGITS}f}\n"
            for k, value in enumerate(table.forward_mm)
        ]
        settings = placing(table.position_mm) | {"IS_MODULO": 0}
        lines += [f"$AA_ENC_COMP_{name}[0,{axis}]={value}\n" for name, value in settings.items()]
    path = folder / "AX_EEC.INI"
    path.write_text("".join(lines) + "M17\n", encoding="utf-8")
    return [path]


def read_enc_comp(folder: Path) -> EncoderCompensation:
    """Read ``AX_EEC.INI``."""
    tables = read_tables(folder / "AX_EEC.INI", _ENC_LINE)
    return EncoderCompensation({"XYZ".index(axis): table for axis, table in tables.items()})


def errors_of_enc(folder: Path, options: Mapping[str, Any]) -> HeldErrors:
    """The entries, which are errors; both directions alike."""
    tables = {}
    for axis, table in read_enc_comp(folder).tables.items():
        position = table.positions()
        tables[error_name(axis, axis)] = (position, table.at(position), table.at(position))
    return HeldErrors(tables)


def _own_axis_mean(_: TableTask) -> list[Term]:
    return [Term(k, k) for k in range(3)]


def _write_enc(
    folder: Path, task: TableTask, knots: tuple[Knots, Knots, Knots], options: Mapping[str, Any]
) -> list[Path]:
    return write_enc_comp(folder, projected(task, _own_axis_mean(task), knots)[1])


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
)
