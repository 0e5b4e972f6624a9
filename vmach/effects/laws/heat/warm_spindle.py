"""What the effects of a warm spindle have in common: its heat goes with a power of the speed.

Source: ISO 230-3 (test of the rotating spindle); the power of the speed is empirical.
"""

from __future__ import annotations

from vmach.effects.effect import Effect
from vmach.effects.parameter import inner

__all__ = ["SPEED_EXPONENT", "OfWarmSpindle"]

SPEED_EXPONENT = inner(
    "speed_exponent",
    "of the heat with the speed",
    (0.4, 0.7, 1.0, 1.5),
    usual=0.7,
    spread=0.3,
)


class OfWarmSpindle(Effect):
    """Base of the effects that follow the spindle's warmth."""

    slack_time_s = 1500.0

    def not_testable(self, path, target):
        return None if (path.moves.spindle_rpm != 0).any() else "the spindle never turned"
