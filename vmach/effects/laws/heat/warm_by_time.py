"""What warms evenly from the start on, whatever the machine does: by coolant, chips or the shop.

Source: closed form derived here: one body that warms by Newton's law: 1 - exp(-t / tau).
"""

import numpy as np

from vmach.effects.effect import Effect
from vmach.effects.parameter import inner

__all__ = ["OfWarmthByTime"]


class OfWarmthByTime(Effect):
    """Base of the effects that follow one warmth; their inner parameter is ``time_constant_s``."""

    slack_share = 0.1
    slack_time_s = 1500.0

    @staticmethod
    def time_constant(meaning: str):
        """The parameter ``time_constant_s``."""
        grid = (400, 700, 1200, 2000, 3300, 5500, 10000)
        return inner("time_constant_s", meaning, grid, usual=2500.0, spread=0.7)

    @staticmethod
    def warmth(path, time_constant_s: float) -> np.ndarray:
        """Share of the final warmth, (P,); none before the start, when zeros are touched."""
        return -np.expm1(-np.maximum(path.time_s, 0.0) / time_constant_s)
