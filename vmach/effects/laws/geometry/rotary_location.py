"""Rotary location: the axis of a rotary table is not where the control believes."""

import numpy as np

from vmach.effects.effect import Effect
from vmach.effects.parameter import linear

__all__ = ["RotaryLocation"]


class RotaryLocation(Effect):
    """An eccentric rotary axis: a first harmonic of its angle across the axis."""

    name = "rotary_location"
    title = "location error of a rotary axis"
    commonness = 1
    shows_as = "offset of a rotary axis"
    law = "(1 - R(c)) offset, R the rotation by the angle c of the axis"
    source = "equation (34) of docs/laws.md; ISO 230-7, XOC, YOC and the like"
    parameters = (
        linear("first_um", "offset along the first direction across the axis", usual=15.0),
        linear("second_um", "offset along the second direction", usual=15.0),
    )
    targets = ("A", "B", "C")
    rarity = 0.5
    usual_size = "5 to 50 um"
    confirm = "R-test: sphere on the table, rotary axis turned, linear axes following"
    cure = "measure and enter the centre of rotation"

    def displacement(self, path, target, first_um, second_um):
        axis = "ABC".index(target)
        start = path.moves.rotary_start_deg[path.states.move, axis]
        end = path.moves.rotary_end_deg[path.states.move, axis]
        angle = np.radians(start + path.states.parameter * (end - start))
        cos, sin = 1.0 - np.cos(angle), -np.sin(angle)
        shift = np.zeros((len(path), 3))
        shift[:, (axis + 1) % 3] = 1e-3 * (first_um * cos - second_um * sin)
        shift[:, (axis + 2) % 3] = 1e-3 * (first_um * sin + second_um * cos)
        return shift

    def not_testable(self, path, target):
        axis = "ABC".index(target)
        moved = np.ptp(path.moves.rotary_end_deg[:, axis]) if len(path.moves) else 0.0
        return None if moved > 0 else f"the {target} axis never turned"
