"""Spindle growth: the warm spindle gets longer."""

from vmach.effects.effect import along
from vmach.effects.laws.heat.warm_spindle import SPEED_EXPONENT, OfWarmSpindle
from vmach.effects.parameter import inner, linear

__all__ = ["SpindleGrowth"]


class SpindleGrowth(OfWarmSpindle):
    """The tip sinks with the spindle's warmth, and rises again when it stands."""

    name = "spindle_growth"
    title = "growth of the warm spindle"
    commonness = 33
    shows_as = "the tip sinks while the spindle warms"
    law = "-growth g_S(τ, k) ê_z"
    source = (
        "equation (2) of docs/laws.md; ISO 230-3, distortion by the rotating spindle; closed "
        "form derived here: one body warms by Newton's law"
    )
    parameters = (
        linear("growth_um", "lengthening when warm at 8000 rpm", usual=20.0),
        inner(
            "time_constant_s",
            "time to reach 63 % of the final growth",
            (120, 200, 320, 500, 750, 1100, 1600, 2300, 3300, 5000, 8000),
            usual=1500.0,
            spread=0.7,
        ),
        SPEED_EXPONENT,
    )
    targets = ("Z",)
    slack_share = 0.2
    usual_size = "10 to 100 um with a time constant of 5 to 60 minutes"
    confirm = "drift test: run the spindle for an hour, then let it stand, with a probe on the tool"
    cure = "warm up before finishing, touch off the tool again, or compensate by temperature"

    def displacement(self, path, target, growth_um, time_constant_s, speed_exponent):
        warmth = path.warmth_of_spindle(time_constant_s, speed_exponent)
        return along(target, -1e-3 * growth_um * warmth)
