"""Datums: the workpiece does not stand where the control believes."""

import numpy as np

from gcode import WORK_OFFSETS
from vmach.effects.effect import Effect
from vmach.effects.laws.tool.sudden import Sudden, moment
from vmach.effects.parameter import linear

__all__ = ["DatumShift", "Fixture"]


class Fixture(Effect):
    """Between two set-ups the part was shifted and turned; target: number of the work offset."""

    name = "fixture"
    title = "clamping of one set-up against the first"
    commonness = 14
    shows_as = "one set-up against the others"
    law = "shift + turn × p', in one work offset; p' from its zero"
    source = (
        "equation (21) of docs/laws.md; closed form derived here: a rigid body that is "
        "shifted and turned a little: d + w x p"
    )
    parameters = (
        linear("shift_x_um", "shift of the tool against the part along X", usual=30.0),
        linear("shift_y_um", "along Y", usual=30.0),
        linear("shift_z_um", "along Z", usual=30.0),
        linear("turn_a_urad", "rotation about X at the work offset", usual=100.0),
        linear("turn_b_urad", "about Y", usual=100.0),
        linear("turn_c_urad", "about Z", usual=100.0),
    )
    targets = ()
    needs_surface = True
    rarity = 1.0
    usual_size = "10 to 200 um and 0.1 to 1 mrad"
    confirm = "probe the datum surfaces on the machine after each clamping"
    cure = "probe and correct the work offset of the set-up"

    def possible_targets(self, job):
        return tuple(list(job.work_offsets_mm)[1:])

    def not_testable(self, path, target):
        used = np.unique(path.work_offset)
        return None if len(used) > 1 else "the part was made in one set-up"

    def displacement(self, path, target, **six):
        shift = np.array([six[f"shift_{axis}_um"] for axis in "xyz"])
        turn = np.array([six[f"turn_{axis}_urad"] for axis in "abc"])
        inside = (path.work_offset == 1 + WORK_OFFSETS.index(target)).astype(float)
        moved = 1e-3 * shift + np.cross(1e-6 * turn, path.in_work_offset_mm)
        return inside[:, None] * moved

    def tool_shift(self, path, target, **parameters):
        return self.displacement(path, target, **parameters)


class DatumShift(Sudden):
    """From one moment on everything is shifted: a collision, a slipped clamp, a lost datum."""

    name = "datum_shift"
    title = "sudden shift of the datum (collision, slipped clamping)"
    commonness = 13
    shows_as = "everything after a moment"
    law = "shift H(t - t_0)"
    source = "equation (22) of docs/laws.md; closed form derived here: a step in time"
    parameters = (
        linear("shift_x_um", "shift of the tool against the part along X", usual=15.0),
        linear("shift_y_um", "along Y", usual=15.0),
        linear("shift_z_um", "along Z", usual=15.0),
        moment("when it happened"),
    )
    targets = ("",)
    needs_surface = True
    rarity = 1.0
    usual_size = "any"
    confirm = "probe the datums again and compare with the start of the program"
    cure = "find the collision or the loose clamp; probe between operations"

    def displacement(self, path, target, shift_x_um, shift_y_um, shift_z_um, time_s):
        after = (path.time_s > time_s).astype(float)
        return 1e-3 * after[:, None] * np.array([shift_x_um, shift_y_um, shift_z_um])

    def tool_shift(self, path, target, **parameters):
        return self.displacement(path, target, **parameters)
