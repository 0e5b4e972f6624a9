"""Reflector: a measuring point of the error tables is documented wrongly."""

from dataclasses import replace

import numpy as np

from vmach.effects.effect import Effect, along
from vmach.effects.parameter import linear
from vmach.machine import LINEAR_AXES
from vmach.machine.component_errors import component_of

__all__ = ["Reflector"]

#: what is farther from where it was written down is no slip of a ruler or of a sign
_FARTHEST_MM = 1000.0


class Reflector(Effect):
    """The reflector stood elsewhere: the angles of the axis enter its reading differently.

    The target is the linear component; the two parameters are true minus documented position
    in the two directions across the one measured, in cyclic order.
    """

    name = "reflector"
    title = "documented position of a reflector"
    commonness = 2
    shows_as = "documented place of a reflector"
    law = "-(θ_j × offset)_i ê_i, θ_j the tilt by the angular tables of axis j"
    source = (
        "equation (33) of docs/laws.md; the Abbe-consistent model (virtual machining of "
        "free-form slots), e = E + theta x (r - R); closed form derived here: R off by d "
        "changes e by -theta x d"
    )
    parameters = tuple(
        replace(linear(name, meaning, usual=100.0), most=_FARTHEST_MM)
        for name, meaning in (
            ("first_mm", "first direction across the one measured (X: Y, Y: Z, Z: X)"),
            ("second_mm", "second direction across (X: Z, Y: X, Z: Y)"),
        )
    )
    targets = tuple(f"E{kind}{axis}" for axis in LINEAR_AXES for kind in LINEAR_AXES)
    rarity = 2.0
    usual_size = "centimetres to decimetres"
    confirm = "measure the component again and write down where the reflector stands"
    cure = "correct measured_at_mm in the machine file"

    def displacement(self, path, target, first_mm, second_mm):
        direction, axis, _ = component_of(target)
        offset = np.zeros(3)
        offset[(direction + 1) % 3], offset[(direction + 2) % 3] = first_mm, second_mm
        # the arm of the axis' angles in this direction begins at the reflector
        read = np.cross(path.axis_tilt_rad[axis], offset)[:, direction]
        return along(LINEAR_AXES[direction], -read)

    def not_testable(self, path, target):
        components = path.job.machine.components
        if not any(f"E{kind}{target[2]}" in components for kind in "ABC"):
            return f"the machine file has no angular tables of axis {target[2]}"
        if target not in components or components[target].measured_at_mm is None:
            return f"the machine file does not say where {target} was measured"
        return None
