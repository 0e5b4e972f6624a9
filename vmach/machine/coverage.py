"""Where a path leaves the error tables, and what holds there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.machine.component_errors import component_of
from vmach.machine.interpolation import Extrapolation
from vmach.machine.machine import Machine

__all__ = ["Uncovered", "uncovered"]


@dataclass(frozen=True)
class Uncovered:
    """A component error that was asked for beyond its table.

    Attributes
    ----------
    component : str
        ISO 230-1 symbol; the last letter is the axis.
    table_mm, asked_mm : (float, float)
        Range of the table, and of the positions.
    states : int
        How many positions lie beyond the table.
    extrapolation : Extrapolation
        What was done there; `displacement` refuses such positions itself for `REFUSE`.
    """

    component: str
    table_mm: tuple[float, float]
    asked_mm: tuple[float, float]
    states: int
    extrapolation: Extrapolation

    def __str__(self) -> str:
        (low, high), (least, most) = self.table_mm, self.asked_mm
        return (
            f"{self.component}: {self.states} positions beyond the table ({low:g} .. {high:g} mm, "
            f"asked for {least:g} .. {most:g} mm), extrapolation '{self.extrapolation}'"
        )


def uncovered(machine: Machine, nose_mm: np.ndarray) -> tuple[Uncovered, ...]:
    """The component errors whose tables do not reach all the positions (P, 3)."""
    found = []
    for name, component in machine.components.items():
        position = np.asarray(nose_mm)[:, component_of(name)[1]]
        low, high = component.range_mm
        beyond = int(np.count_nonzero((position < low) | (position > high)))
        if beyond:
            asked = (float(position.min()), float(position.max()))
            found.append(Uncovered(name, (low, high), asked, beyond, component.extrapolation))
    return tuple(found)
