"""Workpiece warming: the cut heats the part little by little."""

from dataclasses import replace

import numpy as np

from vmach.effects.laws.heat.warm_by_time import OfWarmthByTime
from vmach.effects.parameter import linear

__all__ = ["WorkpieceWarming"]


class WorkpieceWarming(OfWarmthByTime):
    """What is cut late is cut into a longer part, and is too small and too near when it is cold.

    The part stands on the bottom of its blank, and stretches sideways from wherever it is held.
    """

    name = "workpiece_warming"
    title = "workpiece that warms while it is cut"
    commonness = 20
    shows_as = "the part warms while it is cut: what is cut late shrinks more"
    law = "-g(τ) (expansion (p - bottom) + at_zero)"
    source = (
        "equation (15) of docs/laws.md; ISO 1, reference temperature; closed form derived "
        "here: -alpha dT(t) p, dT by Newton's law"
    )
    parameters = (
        replace(
            linear("expansion_ppm", "stretch when warm: expansion coefficient x warming", usual=20),
            is_essential=True,
        ),
        linear("at_zero_x_um", "how far the workpiece zero has moved along X then", usual=5.0),
        linear("at_zero_y_um", "how far it has moved along Y", usual=5.0),
        OfWarmthByTime.time_constant("time to reach 63 % of the final stretch"),
    )
    targets = ("",)
    needs_surface = True
    rarity = 0.5
    usual_size = "23 ppm per kelvin in aluminium, 12 in steel; warm after 10 to 60 minutes"
    confirm = "log the part's temperature while it is cut; cut one early feature again at the end"
    cure = "flood coolant at measuring temperature, finish in one go after a pause to cool"

    def displacement(self, path, target, expansion_ppm, at_zero_x_um, at_zero_y_um, **time):
        blank = path.job.blank
        bottom = np.array([0.0, 0.0, 0.0 if blank is None else blank.min_mm[2]])
        stretch_mm = 1e-6 * expansion_ppm * (path.on_part_mm - bottom)
        moved_mm = stretch_mm + 1e-3 * np.array([at_zero_x_um, at_zero_y_um, 0.0])
        return -self.warmth(path, **time)[:, None] * moved_mm

    def tool_shift(self, path, target, **parameters):
        return self.displacement(path, target, **parameters)
