"""CSV files of instruments: named columns, checked."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from vmach.errors import InputError
from vmach.files.text_file import column_hint, csv_rows, decimal_number, read_text

__all__ = ["Columns", "finite_number", "read_columns", "rows_below"]


@dataclass(frozen=True)
class Columns:
    """Named columns of one file, and the line that each row stands on.

    `order_is_stated` says whether the rows are known to follow each other in time.
    """

    path: Path
    lines: np.ndarray
    text: dict[str, np.ndarray]
    numbers: dict[str, np.ndarray]
    order_is_stated: bool = True

    def take(self, rows: np.ndarray) -> Columns:
        """Some of the rows, (R,) index, in that order."""
        text, numbers = (
            {name: values[rows] for name, values in own.items()}
            for own in (self.text, self.numbers)
        )
        return replace(self, lines=self.lines[rows], text=text, numbers=numbers)

    def vectors(self, names: Sequence[str]) -> np.ndarray:
        """Several columns side by side, (P, K) float64."""
        return np.column_stack([self.numbers[name] for name in names])

    def line_of(self, rows: np.ndarray) -> int:
        """Line of the first of some rows, (P,) bool."""
        return int(self.lines[np.argmax(rows)])


def read_columns(
    path: Path,
    *,
    numbers: Sequence[str],
    text: Sequence[str] = (),
    optional: Sequence[str] = (),
) -> Columns:
    """Read a CSV file with a header; the order of the columns is free.

    Columns of `optional` are among the others, and may be missing.

    Raises
    ------
    InputError
        No such file, a column missing or there twice, no rows, a cell that is no finite number.
    """
    rows = list(csv_rows(read_text(path, what="measurement file").splitlines(), path))
    header = [cell.strip() for cell in rows[0]] if rows else []
    for name in (*text, *numbers):
        if name not in header and name not in optional:
            raise InputError(
                f"column '{name}' is missing",
                file=path,
                line=1,
                accepted=", ".join((*text, *numbers)),
                hint=column_hint(header),
            )
    text, numbers = ([n for n in names if n in header] for names in (text, numbers))
    twice = [n for n, times in Counter(header).items() if times > 1 and n in (*text, *numbers)]
    if twice:
        raise InputError(
            f"column '{twice[0]}' is there {header.count(twice[0])} times",
            file=path,
            line=1,
            accepted="every column once",
        )
    body = rows_below(rows, path)
    cells = {name: [row[k].strip() for _, row in body] for k, name in enumerate(header)}
    values = {name: _numbers(cells[name], name, path, body) for name in numbers}
    lines = np.array([line for line, _ in body])
    return Columns(path, lines, {name: np.array(cells[name]) for name in text}, values)


def rows_below(rows: Sequence[list[str]], path: Path) -> list[tuple[int, list[str]]]:
    """Rows below the heading that hold something, each with its line.

    Raises
    ------
    InputError
        No rows, or one with more or fewer cells than the heading.
    """
    body = [(line, row) for line, row in enumerate(rows[1:], 2) if any(row)]
    if not body:
        raise InputError("no rows of data", file=path)
    for line, row in body:
        if len(row) != len(rows[0]):
            raise InputError(
                f"{len(row)} cells", file=path, line=line, accepted=f"{len(rows[0])} as in line 1"
            )
    return body


def _numbers(
    cells: list[str], name: str, path: Path, body: Sequence[tuple[int, list[str]]]
) -> np.ndarray:
    pairs = zip(cells, body, strict=True)
    return np.array([finite_number(cell, name, path, line) for cell, (line, _) in pairs])


def finite_number(cell: str, name: str, path: Path, line: int) -> float:
    """The number in a cell of a named column.

    Raises
    ------
    InputError
        A cell that is no finite number.
    """
    value = decimal_number(cell)
    if not np.isfinite(value):
        raise InputError(
            f"{name} is '{cell}'", file=path, line=line, accepted="a finite number such as -1.25"
        )
    return value
