"""A value found on the part, and how it follows the deviation of every point.

Source: closed form derived here: to first order a value changes by the sum of weight times
deviation; values of form that are proportional to the deviations are that sum itself (Euler).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["Measure", "largest"]


@dataclass(frozen=True)
class Measure:
    """A characteristic's value.

    Attributes
    ----------
    value_mm : float
    rows : (N,) int
        Points that it depends on; a point may occur more than once.
    weight : (N,) float64
        Change of the value with the deviation of each.
    label : str
        Which of several values of one characteristic: ``smallest``, ``largest``, ...
    """

    value_mm: float
    rows: np.ndarray
    weight: np.ndarray
    label: str = ""

    def spread(self, count: int) -> np.ndarray:
        """Weights of all of `count` points, (count,)."""
        return np.bincount(self.rows, self.weight, count)

    def scaled(self, factor: float) -> Measure:
        """The value and its weights times a factor."""
        return Measure(factor * self.value_mm, self.rows, factor * self.weight, self.label)


def largest(measures: list[Measure]) -> Measure:
    """The largest of some values."""
    return max(measures, key=lambda measure: measure.value_mm)
