"""Error vectors on a grid over the volume of a machine.

Source: Huddersfield paper, section 4.1 (points at the intervals of a grid).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vmach.errors import InputError
from vmach.machine import LINEAR_AXES, Machine, Variant, displacement
from vmach.machine.component_errors import component_of
from vmach.machine.tables.interpolation import Extrapolation

__all__ = ["ErrorField", "Volume", "error_field", "measured_volume"]

_STATES_AT_ONCE = 400_000  #: bounds the memory


@dataclass(frozen=True)
class Volume:
    """A box of nose positions with a regular grid.

    Attributes
    ----------
    low_mm, high_mm : (3,) float64
    counts : (int, int, int)
        Grid points along X, Y, Z, both ends included; 1 puts a single one in the middle.
    """

    low_mm: np.ndarray
    high_mm: np.ndarray
    counts: tuple[int, int, int]

    def __post_init__(self) -> None:
        if min(self.counts) < 1 or not np.all(np.asarray(self.low_mm) < np.asarray(self.high_mm)):
            raise InputError(
                f"volume {self.low_mm} .. {self.high_mm} mm with {self.counts} points",
                accepted="low < high on every axis, one point or more",
            )

    @property
    def coordinates_mm(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Grid positions along X, Y and Z, (N,) mm each, as many as `counts` says."""
        return tuple(
            np.linspace(low, high, count) if count > 1 else np.array([0.5 * (low + high)])
            for low, high, count in zip(self.low_mm, self.high_mm, self.counts, strict=True)
        )


@dataclass(frozen=True)
class ErrorField:
    """Displacement of the tool tip on the grid of a volume.

    Attributes
    ----------
    volume : Volume
    error_mm : (P, 3) float64
        P = product of the counts, X slowest, Z fastest.
    """

    volume: Volume
    error_mm: np.ndarray

    def nose_mm(self, index: int | np.ndarray) -> np.ndarray:
        """Position of grid points by their index, (..., 3) mm."""
        steps = np.unravel_index(index, self.volume.counts)
        coordinates = zip(self.volume.coordinates_mm, steps, strict=True)
        return np.stack([along[step] for along, step in coordinates], axis=-1)

    @property
    def magnitude_mm(self) -> np.ndarray:
        """(P,) length of every error vector."""
        return np.linalg.norm(self.error_mm, axis=1)


def error_field(
    machine: Machine, volume: Volume, tool_mm: np.ndarray, variant: Variant
) -> ErrorField:
    """Error vector at every grid point; the mean of both directions where they differ.

    Parameters
    ----------
    machine : Machine
    volume : Volume
    tool_mm : (3,) float64
        Vector from nose to tip.
    variant : Variant
    """
    x, y, z = volume.coordinates_mm
    plane = np.stack(np.meshgrid(y, z, indexing="ij"), axis=-1).reshape(-1, 2)
    error = np.empty((len(x) * len(plane), 3))
    slab = max(1, _STATES_AT_ONCE // len(plane))
    for start in range(0, len(x), slab):
        here = x[start : start + slab]
        nose = np.column_stack((np.repeat(here, len(plane)), np.tile(plane, (len(here), 1))))
        rows = slice(start * len(plane), start * len(plane) + len(nose))
        error[rows] = displacement(machine, nose, tool_mm, variant).shift_mm
    return ErrorField(volume, error)


def measured_volume(machine: Machine, counts: tuple[int, int, int]) -> Volume:
    """The travel of the machine, as far as tables reach that refuse extrapolation."""
    low, high = machine.travel_mm
    for name, component in machine.components.items():
        if component.extrapolation is Extrapolation.REFUSE:
            axis = component_of(name)[1]
            low[axis] = max(low[axis], component.range_mm[0])
            high[axis] = min(high[axis], component.range_mm[1])
    for axis, name in enumerate(LINEAR_AXES):
        if low[axis] >= high[axis]:
            raise InputError(
                f"the tables of {name} have no position within its travel in common",
                accepted='extrapolation = "hold" or "linear" in the machine file',
            )
    return Volume(low, high, counts)
