"""Tables whose positions count from elsewhere, or against the axis, put on the axis' own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vmach.machine.tables.error_table import ErrorTable
from vmach.machine.tables.runs import Runs

__all__ = ["in_machine_coordinates"]


def in_machine_coordinates(
    table: ErrorTable, zero_mm: float, *, reverse: bool, swap: bool, negate: bool
) -> ErrorTable:
    """A table over the positions of its axis, increasing.

    Parameters
    ----------
    table : ErrorTable
        Over positions s as the file counts them.
    zero_mm : float
        Where the axis is at s = 0, machine coordinates.
    reverse : bool
        The axis is at ``zero_mm - s`` instead of ``zero_mm + s``.
    swap : bool
        Forward was meant along s: with `reverse` it is backward of the axis.
    negate : bool
        The deviation, too, was counted along s: that of the axis has the other sign.
    """
    order = slice(None, None, -1) if reverse else slice(None)
    factor = -1.0 if negate else 1.0

    def position(given: np.ndarray) -> np.ndarray:
        return (zero_mm - given if reverse else zero_mm + given)[order]

    def sides(forward: np.ndarray, backward: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        first, second = (backward, forward) if swap else (forward, backward)
        return factor * first[..., order], factor * second[..., order]

    runs = table.runs
    if runs is not None:
        numbers = runs.forward_number, runs.backward_number
        runs = Runs(
            position(runs.position_mm),
            *sides(runs.forward, runs.backward),
            *(numbers[::-1] if swap else numbers),
            notes=runs.notes,
        )
    forward, backward = sides(table.forward, table.backward)
    return replace(
        table, position=position(table.position), forward=forward, backward=backward, runs=runs
    )
