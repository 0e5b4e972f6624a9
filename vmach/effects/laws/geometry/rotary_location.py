"""Rotary location: the line of a rotary axis is not where the control believes (ISO 230-7)."""

from vmach.effects.effect import Effect
from vmach.effects.parameter import linear
from vmach.machine import RigidDisplacement
from vmach.machine.chain import ROTARY_AXES

__all__ = ["RotaryLocation", "RotaryTilt"]

_CONFIRM = "R-test: sphere on the table, rotary axis turned, linear axes following"


def _across(kinds: str) -> tuple[str, ...]:
    """Location errors of each rotary axis in the directions across it, without the E."""
    pairs = zip(ROTARY_AXES, range(3), strict=True)
    return tuple(f"{kinds[(k + step) % 3]}0{axis}" for axis, k in pairs for step in (1, 2))


class RotaryLocation(Effect):
    """An eccentric rotary axis: a first harmonic of its angle across the axis."""

    name = "rotary_location"
    title = "location error of a rotary axis"
    commonness = 35
    shows_as = "offset of a rotary axis"
    law = "(1 - R(c)) offset on the workpiece, R the rotation by the angle c of the axis"
    source = "equation (34) of docs/laws.md; ISO 230-7, XOC, YOC and the like"
    parameters = (linear("offset_um", "displacement of the axis' line", usual=15.0),)
    targets = _across("XYZ")
    usual_size = "5 to 50 um"
    confirm = _CONFIRM
    cure = "measure and enter the centre of rotation"

    def is_unmeasured(self, machine, target):
        return _axis_of(target) in machine.rotary and not any(
            machine.rotary[_axis_of(target)].location_mm
        )

    def displacement(self, path, target, offset_um):
        return _of_location_error(path, target, 1e-3 * offset_um)

    def not_testable(self, path, target):
        return _why_it_never_acts(path, target)


class RotaryTilt(Effect):
    """A rotary axis that is not parallel to its linear one: face and height turn with it."""

    name = "rotary_tilt"
    title = "parallelism of a rotary axis"
    commonness = 35
    shows_as = "tilt of a rotary axis"
    law = "((1 - R(c)) tilt) × (tip - centre of the axis) on the workpiece"
    source = "equation (36) of docs/laws.md; ISO 230-7, AOC, BOC and the like"
    parameters = (linear("tilt_urad", "rotation of the axis' line, right-handed", usual=30.0),)
    targets = _across("ABC")
    usual_size = "10 to 50 urad"
    confirm = _CONFIRM
    cure = "align the table, or enter the direction of the axis"

    def is_unmeasured(self, machine, target):
        return _axis_of(target) in machine.rotary and not any(
            machine.rotary[_axis_of(target)].location_rad
        )

    def displacement(self, path, target, tilt_urad):
        return _of_location_error(path, target, 1e-6 * tilt_urad)

    def not_testable(self, path, target):
        return _why_it_never_acts(path, target)


def _axis_of(target: str) -> str:
    """The rotary axis of a location error such as ``X0C``."""
    return target[-1]


def _of_location_error(path, target: str, size: float) -> RigidDisplacement:
    """Displacement by a location error in mm or rad.

    Source: equations (34), (36) of docs/laws.md; ISO 230-7, location errors of an axis.
    """
    if _axis_of(target) not in path.job.machine.rotary:
        return RigidDisplacement.zero(len(path))
    lever = path.location_lever(f"E{target}")
    return RigidDisplacement(size * lever.shift_mm, size * lever.tilt_rad)


def _why_it_never_acts(path, target: str) -> str | None:
    axis = _axis_of(target)
    angle_deg = path.moves.rotary_end_deg[:, ROTARY_AXES.index(axis)]
    return None if angle_deg.any() else f"the {axis} axis never turned"
