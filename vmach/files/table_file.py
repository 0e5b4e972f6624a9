"""A table written as the file's ending says: CSV, NumPy's .npz or Parquet."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from vmach.errors import InputError
from vmach.files.atomic import atomic_file
from vmach.files.csv_table import Cells, write_csv
from vmach.files.ending import check_ending

__all__ = ["check_table_file", "write_table"]

_CSV, _NPZ, _PARQUET = ".csv", ".npz", ".parquet"


def check_table_file(path: Path | None) -> None:
    """Refuse an ending that is not written, or not here; asked before the work begins.

    Raises
    ------
    InputError
    """
    check_ending(path, (_CSV, _NPZ, _PARQUET), what="a table")
    if path is not None and _ending(path) == _PARQUET and find_spec("pyarrow") is None:
        raise InputError(
            "Parquet needs the package pyarrow",
            file=path,
            accepted=".csv or .npz, or the installation 'vmach[parquet]'",
        )


def write_table(path: Path, columns: Mapping[str, Cells]) -> None:
    """Write columns of equal length, the whole file or nothing.

    ``.npz`` has an array for every column: empty cells are NaN among numbers and 0 among whole
    numbers. ``.parquet`` has nulls there. ``.csv`` and a name without an ending are CSV.

    Raises
    ------
    InputError
        Another ending, or the file cannot be written.
    """
    check_table_file(path)
    with atomic_file(path) as temporary:
        if _ending(path) == _NPZ:
            arrays: dict[str, Any] = {name: _array(cells) for name, cells in columns.items()}
            with temporary.open("wb") as file:  # by its name, .NPZ would become .NPZ.npz
                np.savez(file, **arrays)
        elif _ending(path) == _PARQUET:
            _write_parquet(temporary, columns)
        else:
            with temporary.open("wb") as file:
                write_csv(file, columns)


def _ending(path: Path) -> str:
    return path.suffix.lower()


def _array(cells: Cells) -> np.ndarray:
    if cells.names is not None:
        return np.asarray(cells.names[cells.values])
    if cells.shown is None:
        return cells.values
    return np.where(cells.shown, cells.values, np.nan if cells.values.dtype.kind == "f" else 0)


def _write_parquet(path: Path, columns: Mapping[str, Cells]) -> None:
    import pyarrow  # late: an extra
    import pyarrow.parquet

    arrays = {}
    for name, cells in columns.items():
        if cells.names is not None:
            arrays[name] = pyarrow.array(cells.names.astype(object)).take(
                pyarrow.array(np.asarray(cells.values, np.int64))
            )
        else:
            hidden = None if cells.shown is None else ~cells.shown
            arrays[name] = pyarrow.array(cells.values, mask=hidden)
    pyarrow.parquet.write_table(pyarrow.table(arrays), path)
