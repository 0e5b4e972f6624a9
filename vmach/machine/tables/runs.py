"""Single runs of a measurement along one axis, both directions of approach.

Source: ISO 230-2, bidirectional runs.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from vmach.base.note import Note

__all__ = ["Runs"]


@dataclass(frozen=True)
class Runs:
    """Deviations read at target positions, approached several times from either side.

    Attributes
    ----------
    position_mm : (K,) float64
        Target positions, increasing; of a rotary axis angles, in degrees where it is evaluated.
    forward, backward : (n, K) float64
        Deviation (actual minus target), approaching in positive and in negative direction, one
        row a run, in one unit; NaN where a reading is missing.
    forward_number, backward_number : (n,) int64
        Number of every run as the file has it; 1, 2, ... where it has none.
    notes : tuple of Note
        What is odd about the numbers in the file.
    """

    position_mm: np.ndarray
    forward: np.ndarray
    backward: np.ndarray
    forward_number: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    backward_number: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        for name in ("forward", "backward"):
            array = np.atleast_2d(np.asarray(getattr(self, name), dtype=float))
            if array.shape[1] != len(self.position_mm):
                raise ValueError(
                    f"Runs.{name} has {array.shape[1]} columns, expected {len(self.position_mm)}"
                )
            object.__setattr__(self, name, array)
            numbers = np.asarray(getattr(self, f"{name}_number"), dtype=np.int64)
            if not numbers.size:
                numbers = np.arange(1, len(array) + 1)
            if numbers.shape != (len(array),):
                raise ValueError(f"Runs.{name} has {len(array)} runs, and {numbers.size} numbers")
            object.__setattr__(self, f"{name}_number", numbers)

    def scaled(self, factor: float) -> Runs:
        """The same runs in another unit."""
        return replace(self, forward=factor * self.forward, backward=factor * self.backward)
