"""CSV files of instruments: named columns, checked; lines that begin with # are comments."""

from __future__ import annotations

import io
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from vmach.errors import InputError
from vmach.files.text_file import (
    DECIMAL_COMMA_HINT,
    column_hint,
    decimal_number,
    numbered_csv_rows,
    read_text,
)

__all__ = ["Columns", "checked_rows", "finite_number", "heading_and_rows", "read_columns"]


@dataclass(frozen=True)
class Columns:
    """Named columns of one file, and the line that each row stands on.

    `order_is_stated` says whether the rows are known to follow each other in time, `unused` which
    columns of the file were not asked for.
    """

    path: Path
    lines: np.ndarray
    text: dict[str, np.ndarray]
    numbers: dict[str, np.ndarray]
    order_is_stated: bool = True
    unused: tuple[str, ...] = ()

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
    accepted: Mapping[str, str] | None = None,
) -> Columns:
    """Read a CSV file with a header; the order of the columns is free, and so are capitals.

    Columns of `optional` are among the others, and may be missing. `accepted` says what numbers a
    column holds, for messages.

    Raises
    ------
    InputError
        No such file, a column missing or there twice, no rows, a cell that is no finite number.
    """
    first, header, below = heading_and_rows(path, (*text, *numbers))
    for name in (*text, *numbers):
        if name not in header and name not in optional:
            raise InputError(
                f"column '{name}' is missing",
                file=path,
                line=first,
                accepted=", ".join((*text, *numbers)),
                hint=column_hint(header),
            )
    text, numbers = ([n for n in names if n in header] for names in (text, numbers))
    twice = [n for n, times in Counter(header).items() if times > 1 and n in (*text, *numbers)]
    if twice:
        raise InputError(
            f"column '{twice[0]}' is there {header.count(twice[0])} times",
            file=path,
            line=first,
            accepted="every column once",
        )
    body = checked_rows(below, len(header), first, path)
    cells = {name: [row[k].strip() for _, row in body] for k, name in enumerate(header)}
    values = {
        name: np.array([
            finite_number(cell, name, path, line, (accepted or {}).get(name))
            for cell, (line, _) in zip(cells[name], body, strict=True)
        ])
        for name in numbers
    }  # fmt: skip
    lines = np.array([line for line, _ in body])
    words = {name: np.array(cells[name]) for name in text}
    unused = tuple(name for name in header if name and name not in (*text, *numbers))
    return Columns(path, lines, words, values, unused=unused)


def heading_and_rows(
    path: Path, known: Sequence[str]
) -> tuple[int, list[str], list[tuple[int, list[str]]]]:
    """Line of the heading, its cells, and the rows below that hold something, each with its line.

    Comments and empty lines are left out. A cell of the heading that is one of the `known` names
    but for capitals becomes that name.

    Raises
    ------
    InputError
        No such file, or an empty one.
    """
    # a line may end within quotation marks
    text = io.StringIO(read_text(path, what="measurement file"))
    rows = [
        (line, row)
        for line, row in numbered_csv_rows(text, path)
        if any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#")
    ]
    if not rows:
        raise InputError("the file is empty", file=path, accepted=f"a heading {', '.join(known)}")
    own = {name.lower(): name for name in known}
    (first, heading), *below = rows
    cells = [cell.strip() for cell in heading]
    return first, [own.get(cell.lower(), cell) for cell in cells], below


def checked_rows(
    rows: list[tuple[int, list[str]]], width: int, first: int, path: Path
) -> list[tuple[int, list[str]]]:
    """The rows below a heading.

    Raises
    ------
    InputError
        No rows, or one with more or fewer cells than the heading.
    """
    if not rows:
        raise InputError("no rows of data", file=path)
    for line, row in rows:
        if len(row) != width:
            raise InputError(
                f"{len(row)} cells",
                file=path,
                line=line,
                accepted=f"{width} as in line {first}",
                hint=DECIMAL_COMMA_HINT if len(row) > width else None,
            )
    return rows


def finite_number(
    cell: str, name: str, path: Path, line: int, accepted: str | None = None
) -> float:
    """The number in a cell of a named column.

    Raises
    ------
    InputError
        A cell that is no finite number.
    """
    value = decimal_number(cell)
    if not np.isfinite(value):
        accepted = accepted or "a finite number such as -1.25"
        raise InputError(f"{name} is '{cell}'", file=path, line=line, accepted=accepted)
    return value
