"""Backlash: the carriage follows its drive only after the lost motion is taken up."""

from vmach.effects.effect import along
from vmach.effects.laws.servo.reversal import TAKE_UP_MM, OfReversal, share_taken_up
from vmach.effects.parameter import inner, linear

__all__ = ["Backlash"]


class Backlash(OfReversal):
    """The axis stays behind by half the reversal value, on the side that it comes from."""

    name = "backlash"
    title = "backlash (lost motion at reversal)"
    commonness = 34
    shows_as = "half the reversal value behind the motion, on either side"
    law = "-(reversal/2) s_j(take_up) ê_j"
    source = (
        "equation (1) of docs/laws.md; ISO 230-2, reversal value B: e = -B / 2 times the "
        "side that it comes from"
    )
    parameters = (
        linear(
            "reversal_um",
            "reversal value B of ISO 230-2; below zero where a control compensates too much",
            usual=10.0,
        ),
        inner(
            "take_up_mm",
            "travel over which the lost motion is taken up to 63 %",
            TAKE_UP_MM,
            usual=0.005,
            spread=1.5,
            optional=True,
        ),
    )
    usual_size = "3 to 15 um on a machining centre, 30 um and more when worn"
    confirm = (
        "approach one position from both sides with a dial gauge or laser; the difference does "
        "not depend on the feed"
    )
    cure = "preload the nut or the bearing, or set the control's backlash compensation"

    def on_one_side(self, path, target, reversal_um, take_up_mm):
        share = share_taken_up(path, self.axis(target), take_up_mm)
        return along(target, -0.5e-3 * reversal_um * share)
