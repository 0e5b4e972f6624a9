"""Single runs of a measurement along one axis, both directions of approach.

Source: ISO 230-2, bidirectional runs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
    """

    position_mm: np.ndarray
    forward: np.ndarray
    backward: np.ndarray

    def __post_init__(self) -> None:
        for name in ("forward", "backward"):
            array = np.atleast_2d(np.asarray(getattr(self, name), dtype=float))
            if array.shape[1] != len(self.position_mm):
                raise ValueError(
                    f"Runs.{name} has {array.shape[1]} columns, expected {len(self.position_mm)}"
                )
            object.__setattr__(self, name, array)

    def scaled(self, factor: float) -> Runs:
        """The same runs in another unit."""
        return Runs(self.position_mm, factor * self.forward, factor * self.backward)
