"""Reading error tables: one file an error, as means or as single runs.

Four headers are understood, in any order of columns and of rows:

* ``position_mm, forward, backward``: means of both directions of approach;
* ``position_mm, error``: one value for both directions;
* ``position_mm, forward_1, backward_1, forward_2, ...``: single runs side by side;
* ``run, position_mm, approach, deviation``: single readings below each other, `approach` being
  the sign of the motion into the position. Without the column `run` the n-th reading of a
  position from one side is that of run n.

The position may also be in ``position_m`` or ``position_inch``; a unit at the end of any other
column (``forward_um``, ``deviation_arcsec``) goes before the unit of the machine file. An empty
cell is a reading that is missing.

Source: ISO 230-2 (target positions, approach from both directions).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from vmach.base.note import Kind, Note, in_file
from vmach.errors import InputError
from vmach.files.text_file import column_hint, csv_rows, decimal_number, read_text
from vmach.machine.tables.run_numbers import (
    LARGEST_RUN,
    NumberedReadings,
    doubled_notes,
    numbering_notes,
)
from vmach.machine.tables.runs import Runs

__all__ = [
    "LARGEST_MM",
    "LARGEST_RAD",
    "MM_PER",
    "POSITION_RAD_PER",
    "RAD_PER",
    "ErrorTable",
    "read_error_table",
]

#: no axis of a machine tool errs by more; the number is in another unit
LARGEST_MM, LARGEST_RAD = 1.0, 0.01

#: an inch is 25.4 mm (ISO 80000-3), a microinch, uin, its millionth part
MM_PER = {"um": 1e-3, "mm": 1.0, "m": 1e3, "inch": 25.4, "uin": 25.4e-6}
RAD_PER = {
    "urad": 1e-6, "rad": 1.0, "mrad": 1e-3, "arcsec": math.pi / 648000, "deg": math.pi / 180,
    "um/m": 1e-6, "um/mm": 1e-3,
}  # fmt: skip
#: columns that the message about a wrong header lists; {} is the unit of the position
_ACCEPTED = (
    "position_{0}, forward, backward | position_{0}, error | "
    "position_{0}, forward_1, backward_1, forward_2, ... | run, position_{0}, approach, deviation"
)
_BOTH_HINT = "readings of one direction, or means of both, go into a column error"
POSITION_RAD_PER = {"deg": math.pi / 180.0, "rad": 1.0}
POSITION_MM_PER = {unit: MM_PER[unit] for unit in ("mm", "m", "inch")}
_NO_NUMBER = -1  #: of a column whose name has none
_SAME_POSITION = 1e-3  #: in the unit of the file


@dataclass(frozen=True)
class ErrorTable:
    """What one file of errors says, in mm or rad.

    Attributes
    ----------
    position, forward, backward : (K,) float64
        Means, sorted by position, gaps filled. Positions in mm, of a rotary axis in rad.
    runs : Runs or None
        The single runs, where the file has them.
    notes : tuple of Note
        What was done to the file's rows: sorted, gaps filled.
    """

    position: np.ndarray
    forward: np.ndarray
    backward: np.ndarray
    runs: Runs | None
    notes: tuple[Note, ...]

    @property
    def as_runs(self) -> Runs:
        """The single runs; of a table of means one run, which is enough for E, M and B."""
        return self.runs or Runs(self.position, self.forward, self.backward)

    @property
    def in_degrees(self) -> Runs:
        """The same of a rotary axis, over degrees."""
        own = self.as_runs
        return replace(own, position_mm=np.degrees(own.position_mm))


def read_error_table(
    path: Path,
    units: Mapping[str, float],
    unit: str,
    *,
    positions: Mapping[str, float] = POSITION_MM_PER,
) -> ErrorTable:
    """Read a table of one error.

    Parameters
    ----------
    path : Path
    units : mapping of unit to its size in mm or rad
        `MM_PER` or `RAD_PER`.
    unit : str
        Of the columns that do not name their own.
    positions : mapping of unit to its size
        Of the column ``position_UNIT``; for a rotary axis in rad, and the table's positions are
        then in rad too.

    Raises
    ------
    InputError
        No such file, wrong header or unit, a cell that is no finite number, fewer than two
        positions, a position twice, an end position without a reading.
    """
    lines = read_text(path, what="error table").splitlines()
    rows = [
        (number, [cell.strip() for cell in cells])
        for number, cells in enumerate(csv_rows(lines, path), 1)
        if any(cell.strip() for cell in cells) and not cells[0].lstrip().startswith("#")
    ]
    if not rows:
        accepted = _ACCEPTED.format(next(iter(positions)))
        raise InputError("the table is empty", file=path, accepted=accepted)
    header = _Header(path, rows[0][0], rows[0][1], units=units, unit=unit, positions=positions)
    values = np.array([_numbers(cells, header, path, line) for line, cells in rows[1:]])
    if len(values) == 0:
        raise InputError("the table has no rows below its header", file=path, line=rows[0][0])
    header.rows = values[:, header.position], [line for line, _ in rows[1:]]
    notes = []
    if np.any(np.diff(values[:, header.position]) < 0):
        notes.append(Note.plain(Kind.ROWS, "rows sorted by position"))
    runs = _long_runs(values, header) if header.approach is not None else _wide_runs(values, header)
    _check_positions(runs.position_mm, header)
    forward, backward = (
        _filled(getattr(runs, way), runs.position_mm, header, notes=notes, way=way)
        for way in ("forward", "backward")
    )
    single = max(len(runs.forward), len(runs.backward)) > 1 or header.approach is not None
    return ErrorTable(runs.position_mm, forward, backward, runs if single else None, tuple(notes))


class _Header:
    """Which column holds what, and its factor to mm or rad."""

    def __init__(
        self,
        path: Path,
        line: int,
        names: list[str],
        *,
        units: Mapping[str, float],
        unit: str,
        positions: Mapping[str, float],
    ) -> None:
        self.path, self.line, self.names = path, line, names
        self.accepted = _ACCEPTED.format(next(iter(positions)))
        #: positions (R,) of all rows, and their lines
        self.rows: tuple[np.ndarray, list[int]] = (np.zeros(0), [])
        is_length = "mm" in units
        self.largest, self.size_unit = (LARGEST_MM, "mm") if is_length else (LARGEST_RAD, "rad")
        self.position, self.position_unit = self._find_position(positions)
        self.position_scale = positions[self.position_unit]
        self.approach = names.index("approach") if "approach" in names else None
        is_numbered = self.approach is not None and "run" in names
        self.run = names.index("run") if is_numbered else None
        self.forward: list[int] = []
        self.backward: list[int] = []
        #: numbers in the names of these columns
        self.forward_number: list[int] = []
        self.backward_number: list[int] = []
        self.scale = np.ones(len(names))
        self.scale[self.position] = self.position_scale
        for column, name in enumerate(names):
            found = re.fullmatch(r"(forward|backward|deviation|error)(_\d+)?(?:_([a-z/]+))?", name)
            if column in (self.position, self.approach) or name in ("run", "t_s"):
                continue
            if found is None or (found[1] == "deviation") != (self.approach is not None):
                raise self._wrong()
            own = found[3] or unit
            if own not in units:
                raise InputError(
                    f"column '{name}': unit '{own}'", file=path, line=line,
                    accepted=", ".join(units),
                )  # fmt: skip
            self.scale[column] = units[own]
            number = int(found[2][1:]) if found[2] else _NO_NUMBER
            if number > LARGEST_RUN:
                raise InputError(
                    f"column '{name}': run {number}", file=path, line=line,
                    accepted=f"run {LARGEST_RUN} at most",
                )  # fmt: skip
            if found[1] != "backward":
                self.forward.append(column)
                self.forward_number.append(number)
            if found[1] != "forward":
                self.backward.append(column)
                self.backward_number.append(number)
        if not self.forward or not self.backward or len(set(names)) < len(names):
            raise self._wrong()

    def line_at(self, position: float) -> int | None:
        """The last line of a position."""
        near = np.abs(self.rows[0] - position) < _SAME_POSITION * self.position_scale
        return next((self.rows[1][k] for k in np.flatnonzero(near)[::-1]), None)

    def _find_position(self, positions: Mapping[str, float]) -> tuple[int, str]:
        for column, name in enumerate(self.names):
            unit = name.removeprefix("position_")
            if unit != name and unit in positions:
                return column, unit
        raise self._wrong()

    def _wrong(self) -> InputError:
        return InputError(
            f"header '{', '.join(self.names)}'",
            file=self.path,
            line=self.line,
            accepted=self.accepted,
            hint=column_hint(self.names) or _BOTH_HINT,
        )


def _numbers(cells: list[str], header: _Header, path: Path, line: int) -> np.ndarray:
    """One row in mm or rad; NaN for an empty cell."""
    numbers = np.array([decimal_number(cell) for cell in cells])
    given = [k for k, cell in enumerate(cells) if cell]
    keys = [header.position] if header.approach is None else [header.position, header.approach]
    if len(numbers) != len(header.names) or not np.isfinite(numbers[given]).all():
        raise InputError(
            f"row '{', '.join(cells)}'", file=path, line=line,
            accepted=f"{len(header.names)} finite numbers, or an empty cell for a missing reading",
        )  # fmt: skip
    if not np.isfinite(numbers[keys]).all():
        raise InputError(f"row '{', '.join(cells)}' has no position", file=path, line=line)
    if header.approach is not None and abs(numbers[header.approach]) != 1:
        approach = cells[header.approach]
        raise InputError(
            f"approach {approach}", file=path, line=line, accepted="1 or -1",
            hint="1 where the motion into the position was in + of the axis, -1 in -",
        )  # fmt: skip
    run = 0.0 if header.run is None else numbers[header.run]
    if header.run is not None and not (0 <= run <= LARGEST_RUN and run % 1 == 0):
        raise InputError(
            f"run '{cells[header.run]}'", file=path, line=line,
            accepted=f"the number of the run: 0, 1, 2, ... {LARGEST_RUN}",
            hint="without a column run the n-th reading of a position from one side is of run n",
        )  # fmt: skip
    values = numbers * header.scale
    sizes = np.abs(values[[*header.forward, *header.backward]])
    if (sizes > header.largest).any():
        raise InputError(
            f"row '{', '.join(cells)}' holds an error of {np.nanmax(sizes):g} {header.size_unit}",
            file=path, line=line, accepted=f"{header.largest:g} {header.size_unit} at most",
            hint="the unit of the column, or [convention] in the machine file, may be another",
        )  # fmt: skip
    return values


def _wide_runs(values: np.ndarray, header: _Header) -> Runs:
    values = values[np.argsort(values[:, header.position], kind="stable")]
    forward, backward = header.forward_number, header.backward_number
    if _NO_NUMBER in (*forward, *backward):
        forward, backward = [], []
    return Runs(
        values[:, header.position],
        values[:, header.forward].T,
        values[:, header.backward].T,
        np.array(forward, np.int64),
        np.array(backward, np.int64),
        notes=in_file(numbering_notes(forward, backward), header.path, header.line),
    )


def _long_runs(values: np.ndarray, header: _Header) -> Runs:
    """Readings by the numbers of their runs; without numbers the n-th belongs to the n-th run."""
    position = values[:, header.position]
    step = _SAME_POSITION * header.position_scale
    targets, target = np.unique(np.round(position / step), return_inverse=True)
    sides, numbers, notes = [], [], []
    for sign in (1.0, -1.0):
        mine = np.sign(values[:, header.approach]) == sign
        run = None if header.run is None else values[mine, header.run].astype(np.int64)
        readings = NumberedReadings(
            target[mine], values[mine, header.forward[0]], run, np.array(header.rows[1])[mine]
        )
        side, number = readings.in_rows(len(targets))
        sides.append(side)
        numbers.append(number)
        places = [_listed([x], header) for x in targets * step]
        notes += in_file(doubled_notes(readings, places, approach=int(sign)), header.path)
    if header.run is not None:
        notes += in_file(numbering_notes(*(n.tolist() for n in numbers)), header.path)
    return Runs(targets * step, *sides, *numbers, notes=tuple(notes))


def _check_positions(position: np.ndarray, header: _Header) -> None:
    if len(position) < 2:
        raise InputError(
            f"{len(position)} position",
            file=header.path,
            line=header.line_at(position[0]),
            accepted="two or more",
        )
    twice = np.flatnonzero(np.diff(position) < _SAME_POSITION * header.position_scale)
    if twice.size:
        raise InputError(
            f"position {position[twice[0]] / header.position_scale:g} occurs twice",
            file=header.path,
            line=header.line_at(position[twice[0]]),
            accepted="every position once",
            hint="single runs go into columns forward_1, forward_2, ...",
        )


def _filled(
    side: np.ndarray, position: np.ndarray, header: _Header, *, notes: list[Note], way: str
) -> np.ndarray:
    """Mean over the runs; an inner position without a reading lies on the line between its
    neighbours, and a note says so."""
    known = np.isfinite(side)
    count = known.sum(axis=0)
    if not (count[0] and count[-1]):
        at = position[0] if not count[0] else position[-1]
        where = "" if not count.any() else f" at {_listed([at], header)}, the end of the table"
        raise InputError(
            f"no {way} reading{where}", file=header.path,
            line=header.line_at(at), accepted="both directions at either end",
            hint="runs of one direction alone go into columns error_1, error_2, ...",
        )  # fmt: skip
    mean = np.where(known, side, 0.0).sum(axis=0) / np.maximum(count, 1)
    gaps = np.flatnonzero(count == 0)
    if gaps.size:
        there = count > 0
        mean[gaps] = np.interp(position[gaps], position[there], mean[there])
        listed = _listed(position[gaps], header)
        said = f"no {way} reading at {listed}: taken from the neighbours"
        notes.append(Note.plain(Kind.ROWS, said, len(gaps), "1", place=way))
    return mean


def _listed(position: Iterable[float], header: _Header) -> str:
    """Positions in the unit of the file."""
    numbers = ", ".join(f"{x / header.position_scale:g}" for x in position)
    return f"{numbers} {header.position_unit}"
