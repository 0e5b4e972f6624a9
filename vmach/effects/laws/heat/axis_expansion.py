"""Axis expansion: the screw of an axis without a scale warms up and gets longer."""

import numpy as np

from vmach.effects.effect import Effect, along
from vmach.effects.parameter import inner, linear
from vmach.effects.wandering import wandering
from vmach.machine import LINEAR_AXES
from vmach.path.heat_history import REFERENCE_AXIS_MM_PER_S

__all__ = ["AxisExpansion"]

#: length of a warm part of the screw
_UNEVEN_MM = 300.0
#: how soon heat from the nut has gone elsewhere
_QUICKLY_S = 150.0


class AxisExpansion(Effect):
    """A scale error that grows while the machine works, about the screw's fixed bearing."""

    name = "axis_expansion"
    title = "expansion of the warm screw"
    commonness = 25
    shows_as = (
        "the screw stretches while it works: evenly, and most where the nut runs (heat equation "
        "along the screw, 13 mm2/s); stated for a mean axis speed of 100 mm/min"
    )
    law = (
        "((expansion q_j + at_home) g_j(τ, c) + local u_j) ê_j, u_j from the heat equation "
        "along the screw"
    )
    source = (
        "equation (10) of docs/laws.md; ISO 230-3, distortion by moving axes; closed form "
        "derived here: alpha dT (q - q_fixed), dT by Newton's law"
    )
    parameters = (
        linear("expansion_ppm", "stretch when warm at a mean speed of 100 mm/min", usual=40.0),
        linear("local_ppm", "further stretch, most where the nut works", usual=40.0),
        linear("at_home_um", "displacement at the axis' home when warm", usual=10.0),
        inner(
            "time_constant_s",
            "time to reach 63 % of the final stretch",
            (300, 600, 1000, 1500, 2300, 3600, 6000),
            usual=1500.0,
            spread=0.7,
        ),
        inner(
            "work_share",
            "share of the heat that follows the axis' own motion",
            (0.02, 1.0),
            usual=1.0,
        ),
    )
    slack_share = 0.05
    slack_time_s = 1500.0
    usual_size = "20 to 100 ppm with a time constant of 10 to 60 minutes"
    confirm = "laser the same line cold, after 30 and after 60 minutes of work"
    cure = "measure with a linear scale, cool the screw, or warm up and re-datum"

    def displacement(
        self, path, target, expansion_ppm, at_home_um, time_constant_s, work_share, local_ppm=0.0
    ):
        axis = LINEAR_AXES.index(target)
        warmth = path.warmth_of_axis(axis, time_constant_s, work_share)
        stretch_mm = 1e-6 * expansion_ppm * path.nose_mm[:, axis] + 1e-3 * at_home_um
        local_mm = 1e-6 * local_ppm * path.warmth_of_screw_mm(axis, time_constant_s)
        return along(target, stretch_mm * warmth + local_mm)

    def needed(self, target):
        return tuple(name for name in super().needed(target) if name != "local_ppm")

    def slack(self, path, target, parameters):
        # beside wandering in time: the screw warms most where the nut works, and was not quite
        # at the temperature of its calibration when it started
        in_time = super().slack(path, target, parameters)
        position = path.nose_mm[:, LINEAR_AXES.index(target)]
        pattern = self.slack_share * self.slack_pattern(path, target, parameters)
        along_screw = wandering(position, _UNEVEN_MM)[:, None, :]
        start = along(target, self.slack_share * 1e-6 * parameters["expansion_ppm"] * position)
        parts = [in_time, pattern[:, :, None] * along_screw, start[:, :, None]]
        if path.states.normal is None:
            # a test at rapid speed heats the nut in minutes as a part does in hours
            parts.append(pattern[:, :, None] * wandering(path.time_s, _QUICKLY_S)[:, None, :])
            parts.append(self._way_to_the_test(path, target, parameters)[:, :, None])
        return np.concatenate(parts, axis=2)

    def _way_to_the_test(self, path, target, parameters):
        """What the way to a test's first reading warmed, which no file tells: about one stroke."""
        position = path.nose_mm[:, LINEAR_AXES.index(target)]
        since = path.time_s / parameters["time_constant_s"]
        strokes = np.ptp(position) / REFERENCE_AXIS_MM_PER_S / parameters["time_constant_s"]
        stretch = 1e-6 * (parameters["expansion_ppm"] + parameters.get("local_ppm", 0.0)) * position
        return along(target, strokes * stretch * np.exp(-since))
