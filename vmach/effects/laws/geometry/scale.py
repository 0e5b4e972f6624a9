"""Scale: the axis is longer or shorter than its drive believes."""

from vmach.effects.effect import Effect, along
from vmach.effects.parameter import linear
from vmach.machine import LINEAR_AXES

__all__ = ["Scale"]


class Scale(Effect):
    """An error in proportion to the distance from home."""

    name = "scale"
    title = "scale error (pitch of the screw or scale, or its temperature)"
    commonness = 30
    shows_as = "in proportion to the distance from home"
    law = "scale q_j ê_j"
    source = (
        "equation (5) of docs/laws.md; ISO 230-2, positioning deviation; closed form derived "
        "here: a pitch wrong by the share a errs by a q"
    )
    parameters = (
        linear("scale_ppm", "um per metre of travel, positive: goes too far", usual=20.0),
    )
    usual_size = "up to 20 ppm; 12 ppm is one kelvin of steel over the scale's reference"
    confirm = "measure the axis with a laser, the material sensor on the screw or scale"
    cure = "set the axis' linear compensation, or mend the temperature compensation"
    imitates_as_team = True
    goes_before_curves = True  # the mean slope of a positioning error (ISO 230-2)

    def is_unmeasured(self, machine, target):
        return f"E{target}{target}" not in machine.components

    def displacement(self, path, target, scale_ppm):
        return along(target, 1e-6 * scale_ppm * path.nose_mm[:, LINEAR_AXES.index(target)])
