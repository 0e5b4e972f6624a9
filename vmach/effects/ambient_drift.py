"""Ambient drift: the shop's temperature moves the tool against the workpiece."""

import numpy as np

from vmach.effects.effect import Effect, along, inner, linear

__all__ = ["AmbientDrift"]


class AmbientDrift(Effect):
    """A slow wave in time, zero at the start."""

    name = "ambient_drift"
    title = "drift with the temperature of the shop"
    parameters = (
        linear("sine_um", "amplitude of the sine of 2 pi time / period", usual=10.0),
        linear("cosine_um", "amplitude of the cosine minus one", usual=10.0),
        inner(
            "period_s",
            "period of the wave",
            (2400, 3400, 4800, 6800, 9600, 14000, 20000, 40000, 86400),
            usual=86400.0,
        ),
    )
    rarity = 1.0
    slack_share = 0.1
    slack_time_s = 3000.0
    usual_size = "5 to 30 um a day for a few kelvin"
    confirm = "drift test with the spindle standing, over a working day (ISO 230-3, ETVE)"
    cure = "keep sun and draught off the machine; probe the datum again before finishing"
    source = "ISO 230-3, environmental temperature variation error"

    def displacement(self, path, target, sine_um, cosine_um, period_s):
        angle = 2 * np.pi * path.time_s / period_s
        return along(target, 1e-3 * (sine_um * np.sin(angle) + cosine_um * (np.cos(angle) - 1)))
