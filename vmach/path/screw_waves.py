"""Cosines along a screw: the temperature along it is a sum of them.

Heat spreads along the steel and is lost to the air with a time constant; no heat leaves by the
ends. So each cosine follows its share of the heat with a lag of its own, 1 / time constant +
diffusivity (m pi / length)^2.

Source: closed form derived here: the heat equation on a rod with insulated ends has the cosines
m pi / length.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

__all__ = ["ScrewWaves"]

#: cosines that the temperature along a screw is made of
_WAVES = 12
#: of carbon steel near room temperature
_STEEL_DIFFUSIVITY_MM2_PER_S = 13.0


@dataclass(frozen=True)
class ScrewWaves:
    """W cosines along a screw.

    Attributes
    ----------
    low_mm, high_mm : float
        Where the screw begins and ends.
    """

    low_mm: float
    high_mm: float

    @cached_property
    def per_mm(self) -> np.ndarray:
        """Angle of each cosine on one millimetre, (W,)."""
        return np.pi * np.arange(1, _WAVES + 1) / (self.high_mm - self.low_mm)

    def lag_s(self, time_constant_s: float) -> np.ndarray:
        """How late each cosine follows its heat, by the time constant of even warmth, (W,)."""
        return 1.0 / (1.0 / time_constant_s + _STEEL_DIFFUSIVITY_MM2_PER_S * self.per_mm**2)

    def heat_mm(self, corner_mm: np.ndarray) -> np.ndarray:
        """Share of each cosine in the heat of the ways between K + 1 corners, (K, W) mm.

        Heat enters the places that the nut passes, by the way it makes there.
        """
        sines = np.sin(np.multiply.outer(corner_mm - self.low_mm, self.per_mm)) / self.per_mm
        forwards = np.sign(np.diff(corner_mm))[:, None]
        return 2.0 * forwards * np.diff(sines, axis=0)

    def sines(self, position_mm: np.ndarray) -> np.ndarray:
        """Each cosine summed from home to positions (P,) of the nut, times its angle, (P, W)."""
        at_home = np.sin(self.per_mm * self.low_mm)
        return np.sin(np.multiply.outer(position_mm - self.low_mm, self.per_mm)) + at_home
