"""Component errors: the tables that a laser, a level or a ballbar left behind."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from vmach.errors import InputError
from vmach.machine.chain import LINEAR_AXES
from vmach.toml_file import read_text

__all__ = ["COMPONENT_NAMES", "ComponentError", "component_of", "read_error_table"]

#: the 18 component errors, ISO 230-1: direction of the error, then the axis that moves
COMPONENT_NAMES = tuple(f"E{kind}{axis}" for axis in LINEAR_AXES for kind in "XYZABC")


def component_of(name: str) -> tuple[int, int, bool]:
    """Direction index (0..2), axis index (0..2) and whether the error is an angle.

    ``EBX`` is the rotation about Y (B) of axis X: ``(1, 0, True)``.
    """
    kind, axis = name[1], name[2]
    angular = kind in "ABC"
    return ("ABC" if angular else "XYZ").index(kind), LINEAR_AXES.index(axis), angular


@dataclass(frozen=True)
class ComponentError:
    """One component error against the position of its axis, in mm or rad.

    Attributes
    ----------
    name : str
        ISO 230-1 symbol such as ``EXX`` or ``EBY``.
    position_mm : (K,) float64
        Axis positions, increasing.
    forward, backward : (K,) float64
        The error approaching in positive and in negative direction, mm or rad.
    measured_at_mm : (3,) float64 or None
        Where the reflector stood, in the frame of the body that the axis carries. Only for
        positioning and straightness.
    """

    name: str
    position_mm: np.ndarray
    forward: np.ndarray
    backward: np.ndarray
    measured_at_mm: np.ndarray | None = None

    @property
    def mean(self) -> np.ndarray:
        """Mean of both directions at the table's positions, (K,), mm or rad."""
        return 0.5 * (self.forward + self.backward)

    def evaluate(self, position_mm: np.ndarray) -> np.ndarray:
        """Mean of both directions, linear between the table's points, mm or rad.

        Beyond the table's ends the end value holds; whether a program may go there is checked
        where the program is (`Machine.check_tables_cover`).
        """
        return np.interp(position_mm, self.position_mm, self.mean)


def read_error_table(path: Path, scale: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Read ``position_mm, forward, backward``; the errors are multiplied by `scale`.

    Returns
    -------
    position_mm, forward, backward : (K,) float64
        Sorted by position.

    Raises
    ------
    InputError
        No such file, wrong header, a cell that is no finite number, fewer than two rows, a
        position twice.
    """
    text = read_text(path, what="error table")
    rows = csv.reader(text.splitlines())
    header = [cell.strip() for cell in next(rows, [])]
    expected = ["position_mm", "forward", "backward"]
    if header != expected:
        raise InputError(
            f"header '{', '.join(header)}'", file=path, line=1, accepted=", ".join(expected)
        )
    values = [_numbers(row, path, line) for line, row in enumerate(rows, 2) if any(row)]
    if len(values) < 2:
        raise InputError(f"{len(values)} rows of data", file=path, accepted="two or more")
    table = np.array(sorted(values))
    twice = np.flatnonzero(np.diff(table[:, 0]) == 0)
    if twice.size:
        raise InputError(f"position {table[twice[0], 0]} mm stands there twice", file=path)
    return table[:, 0], scale * table[:, 1], scale * table[:, 2]


def _numbers(row: list[str], path: Path, line: int) -> tuple[float, ...]:
    try:
        numbers = tuple(float(cell) for cell in row)
    except ValueError:
        numbers = ()
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)):
        raise InputError(
            f"row '{','.join(row)}'", file=path, line=line, accepted="three finite numbers"
        )
    return numbers
