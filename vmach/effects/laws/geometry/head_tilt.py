"""Head tilt: column or head bend when one side of them is warm."""

import numpy as np

from vmach.effects.laws.heat.warm_spindle import SPEED_EXPONENT, OfWarmSpindle
from vmach.effects.parameter import inner, linear
from vmach.machine import RigidDisplacement

__all__ = ["HeadTilt"]


class HeadTilt(OfWarmSpindle):
    """The tool turns with the spindle's warmth: longer tools move further."""

    name = "head_tilt"
    title = "thermal tilt of head or column"
    commonness = 21
    shows_as = "the head turns while it warms"
    law = "g_S(τ, k) (tilt ê × T - shift ê × ê_z), the tool turned by tilt g_S about ê"
    source = (
        "equation (14) of docs/laws.md; ISO 230-3, distortion by the rotating spindle; "
        "closed form derived here: a rotation w moves the tip at T by w x T"
    )
    parameters = (
        linear("tilt_urad", "rotation when warm at 8000 rpm, right-handed", usual=40.0),
        linear("shift_um", "sideways motion of the spindle nose when warm", usual=10.0),
        inner(
            "time_constant_s",
            "time to reach 63 % of the final tilt",
            (300, 600, 1000, 1600, 2500, 4000, 7000),
            usual=3000.0,
            spread=0.8,
        ),
        SPEED_EXPONENT,
    )
    targets = ("A", "B")
    turns_tool = True
    rarity = 0.5
    slack_share = 0.15
    usual_size = "50 urad above 5000 rpm, time constant 0.5 to 4 hours"
    confirm = "drift test with two tool lengths, or with a nest of five probes"
    cure = "warm up before finishing; cool the head; compensate by temperature"

    def displacement(self, path, target, tilt_urad, shift_um, time_constant_s, speed_exponent):
        warmth = path.warmth_of_spindle(time_constant_s, speed_exponent)[:, None]
        turned = np.zeros(3)
        turned["AB".index(target)] = 1.0
        tilt = 1e-6 * tilt_urad * warmth * turned
        sideways = np.cross(turned, [0.0, 0.0, -1.0])
        return RigidDisplacement(
            np.cross(tilt, path.tool_mm) + 1e-3 * shift_um * warmth * sideways, tilt
        )
