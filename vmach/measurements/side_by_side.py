"""Runs side by side: a row of each place, a column of each run from either side.

Source: ISO 230-2, bidirectional runs; within a run the places are reached in turn, out and back.
Which side a run began from such a table does not say.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vmach.errors import InputError
from vmach.measurements.columns import Columns, checked_rows, finite_number, heading_and_rows

__all__ = ["read_side_by_side"]

_RUN = re.compile(r"(forward|backward)_(\d+)(?:_(\w+))?", re.IGNORECASE)
#: sign of the motion into a place
_SIDES = {"forward": 1.0, "backward": -1.0}


def read_side_by_side(path: Path, columns: Sequence[str]) -> Columns | None:
    """The readings of a file in the order of the runs, each forward first.

    None where its runs stand below each other. ``id`` of a reading is its line and column.

    Parameters
    ----------
    path : Path
        With a column of places and ``forward_1, backward_1, forward_2, ...``; an empty cell is a
        reading that is missing.
    columns : sequence of str
        Of a file whose runs stand below each other: run, place, side and reading. The unit of
        the reading is that of the runs too.

    Raises
    ------
    InputError
        No such file, a column twice, in another unit or of something else, no rows, a cell that is
        no finite number.
    """
    run, place, side, reading = columns
    first, header, below = heading_and_rows(path, columns)
    if place not in header or not any(_RUN.fullmatch(name) for name in header):
        return None
    own = [_run_of(name, k, reading) for k, name in enumerate(header) if name != place]
    runs = [one for one in own if one is not None]
    if len(runs) < len(own) or len({(r.number, r.side) for r in runs}) < len(runs):
        raise InputError(
            f"header '{', '.join(header)}'", file=path, line=first,
            accepted=f"{place}, forward_1, backward_1, forward_2, ... in the unit of {reading}",
        )  # fmt: skip
    body = checked_rows(below, len(header), first, path)
    where = header.index(place)
    at = np.array([finite_number(cells[where].strip(), place, path, n) for n, cells in body])
    rows = []
    for one in sorted(runs, key=lambda r: (r.number, -_SIDES[r.side])):
        for k in np.argsort(_SIDES[one.side] * at, kind="stable").tolist():
            line, cells = body[k]
            if cell := cells[one.column].strip():
                value = finite_number(cell, header[one.column], path, line)
                own_id = f"line {line} {header[one.column]}"
                rows.append((line, one.number, at[k], _SIDES[one.side], value, own_id))
    if not rows:
        raise InputError("no readings: all cells are empty", file=path)
    lines, numbers, places, sides, values, ids = map(np.array, zip(*rows, strict=True))
    text = {run: numbers.astype(str), "id": ids}
    found = {place: places, side: sides, reading: values}
    return Columns(path, lines, text, found, order_is_stated=False)


@dataclass(frozen=True)
class _Run:
    """Where a run from one side stands."""

    number: int
    side: str
    column: int


def _run_of(name: str, column: int, reading: str) -> _Run | None:
    """What a column of the header holds; None where that is no run in the unit of the reading."""
    found = _RUN.fullmatch(name)
    if found is None or (found[3] and not reading.endswith(f"_{found[3].lower()}")):
        return None
    return _Run(int(found[2]), found[1].lower(), column)
