"""Workpiece temperature: the part was cut at another temperature than it is measured at."""

from vmach.effects.effect import Effect
from vmach.effects.parameter import linear
from vmach.machine import LINEAR_AXES

__all__ = ["WorkpieceTemperature"]


class WorkpieceTemperature(Effect):
    """The part shrinks alike in all directions when it has cooled down."""

    name = "workpiece_temperature"
    title = "temperature of the workpiece while it was cut"
    commonness = 31
    shows_as = "the part shrinks after cutting"
    law = "-expansion p"
    source = (
        "equation (4) of docs/laws.md; ISO 1, reference temperature; closed form derived "
        "here: -alpha dT p"
    )
    parameters = (
        linear("expansion_ppm", "stretch while cut: expansion coefficient x warming", usual=20.0),
    )
    targets = ("",)
    needs_surface = True
    usual_size = "23 ppm per kelvin in aluminium, 12 in steel"
    confirm = "log the part's temperature while it is cut and while it is measured"
    cure = "cut with coolant at measuring temperature, or scale the program"

    def is_unmeasured(self, machine, target):
        # without any positioning table no length that this machine made was ever compared
        return not any(f"E{axis}{axis}" in machine.components for axis in LINEAR_AXES)

    def displacement(self, path, target, expansion_ppm):
        return -1e-6 * expansion_ppm * path.on_part_mm
