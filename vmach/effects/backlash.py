"""Backlash: the carriage follows its drive only after the lost motion is taken up."""

from vmach.effects.effect import Effect, along, linear
from vmach.machine import LINEAR_AXES

__all__ = ["Backlash"]


class Backlash(Effect):
    """The axis stays behind by half the reversal value, on the side that it comes from."""

    name = "backlash"
    title = "backlash (lost motion at reversal)"
    parameters = (linear("reversal_um", "reversal value B of ISO 230-2", usual=10.0),)
    usual_size = "3 to 15 um on a machining centre, 30 um and more when worn"
    confirm = (
        "approach one position from both sides with a dial gauge or laser; the difference does "
        "not depend on the feed"
    )
    cure = "preload the nut or the bearing, or set the control's backlash compensation"
    source = "ISO 230-2, reversal value"

    def displacement(self, path, target, reversal_um):
        side = path.direction[:, LINEAR_AXES.index(target)]
        return along(target, -0.5e-3 * reversal_um * side)
