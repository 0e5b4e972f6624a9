"""Reflector: a measuring point of the error tables is documented wrongly."""

import numpy as np

from vmach.effects.effect import Effect, linear
from vmach.machine import LINEAR_AXES
from vmach.machine.component_errors import component_of

__all__ = ["Reflector"]


class Reflector(Effect):
    """The reflector stood elsewhere: the angles of the axis enter its reading differently.

    The target is the linear component; the two parameters are true minus documented position
    in the two directions across the one measured, in cyclic order.
    """

    name = "reflector"
    title = "documented position of a reflector"
    parameters = (
        linear("first_mm", "first direction across the measured one (X: Y, Y: Z, Z: X)", usual=100.0),
        linear("second_mm", "second direction across (X: Z, Y: X, Z: Y)", usual=100.0),
    )
    targets = tuple(f"E{kind}{axis}" for axis in LINEAR_AXES for kind in LINEAR_AXES)
    usual_size = "centimetres to decimetres"
    confirm = "measure the component again and write down where the reflector stands"
    cure = "correct measured_at_mm in the machine file"

    def displacement(self, path, target, first_mm, second_mm):
        direction, axis, _ = component_of(target)
        offset = np.zeros(3)
        offset[(direction + 1) % 3], offset[(direction + 2) % 3] = first_mm, second_mm
        machine = path.job.machine
        angles = np.zeros((len(path), 3))
        for turn in range(3):
            table = machine.components.get(f"E{'ABC'[turn]}{target[2]}")
            if table is not None:
                angles[:, turn] = table.evaluate(path.nose_mm[:, axis])
        moved = np.zeros((len(path), 3))
        moved[:, direction] = -np.cross(angles, offset)[:, direction]
        return machine.axis_sign(target[2]) * moved

    def not_testable(self, path, target):
        turning = [f"E{kind}{target[2]}" for kind in "ABC"]
        if not any(name in path.job.machine.components for name in turning):
            return f"the machine file has no angular tables of axis {target[2]}"
        return None
