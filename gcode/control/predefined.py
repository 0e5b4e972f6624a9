"""Parameters that the controller computes: #5420 ..., #<_x>, #<_feed>, #<_plane> ..."""

from __future__ import annotations

from collections.abc import Callable

from gcode.errors import ProgramError
from gcode.state.controller import XY, XZ, YZ, Controller
from gcode.text.parameters import Parameters

__all__ = ["install_predefined", "unknown_input"]


def install_predefined(controller: Controller) -> None:
    """Give `controller.parameters` every parameter that reads the controller's state."""
    computed = controller.parameters.computed
    for axis, name in enumerate("xyzabc"):
        computed[5420 + axis] = _position(controller, axis)
        computed[f"_abs_{name}"] = _machine(controller, axis)
        computed[f"_{name}"] = _program(controller, axis)
    for index in (5426, 5427, 5428):
        computed[index] = lambda: 0.0
    computed.update(_modes(controller))


def _position(controller: Controller, axis: int) -> Callable[[], float]:
    def read() -> float:
        controller.require_no_compensation("read the current position")
        return controller.position[axis]

    return read


def _program(controller: Controller, axis: int) -> Callable[[], float]:
    return lambda: controller.position[axis]


def _machine(controller: Controller, axis: int) -> Callable[[], float]:
    return lambda: controller.machine_position()[axis]


def _modes(c: Controller) -> dict[int | str, Callable[[], float]]:
    planes = {XY: 170.0, XZ: 180.0, YZ: 190.0}
    return {
        "_line": lambda: float(c.line),
        "_motion_mode": lambda: float(-1 if c.motion is None else round(10 * float(c.motion[1:]))),
        "_plane": lambda: planes[c.plane],
        "_ccomp": lambda: {0: 400.0, 1: 410.0, -1: 420.0}[c.side],
        "_metric": lambda: float(c.unit_mm == 1.0),
        "_imperial": lambda: float(c.unit_mm != 1.0),
        "_absolute": lambda: float(c.absolute),
        "_incremental": lambda: float(not c.absolute),
        "_inverse_time": lambda: float(c.feed_mode == "inverse"),
        "_units_per_minute": lambda: float(c.feed_mode == "minute"),
        "_units_per_rev": lambda: float(c.feed_mode == "revolution"),
        "_coord_system": lambda: float(530 + 10 * c.system if c.system < 7 else 584 + c.system),
        "_tool_offset": lambda: float(any(c.tool_offset)),
        "_retract_r_plane": lambda: float(not c.retract_to_initial),
        "_retract_old_z": lambda: float(c.retract_to_initial),
        "_spindle_rpm_mode": lambda: float(not c.css),
        "_spindle_css_mode": lambda: float(c.css),
        "_ijk_absolute_mode": lambda: float(c.arc_absolute),
        "_lathe_diameter_mode": lambda: float(c.diameter_mode),
        "_lathe_radius_mode": lambda: float(not c.diameter_mode),
        "_spindle_on": lambda: float(c.spindle != 0),
        "_spindle_cw": lambda: float(c.spindle == 1),
        "_mist": lambda: float(c.mist),
        "_flood": lambda: float(c.flood),
        "_speed_override": lambda: 1.0,
        "_feed_override": lambda: 1.0,
        "_adaptive_feed": lambda: 0.0,
        "_feed_hold": lambda: 1.0,
        "_feed": lambda: c.feed,
        "_rpm": lambda: abs(c.speed),
        "_current_tool": lambda: float(c.tool),
        "_current_pocket": lambda: float(c.tool),
        "_selected_tool": lambda: float(-1 if c.selected_tool is None else c.selected_tool),
        "_selected_pocket": lambda: float(-1 if c.selected_tool is None else c.selected_tool),
        "_vmajor": lambda: 2.9,
        "_vminor": lambda: 0.0,
        "_task": lambda: 0.0,
        "_call_level": lambda: float(len(c.parameters.locals) - 1),
        "_remap_level": lambda: 0.0,
    }


def unknown_input(parameters: Parameters) -> None:
    """M66: from now on #5399 holds what an input said, which nobody knows here."""

    def read() -> float:
        raise ProgramError(
            "#5399 holds the answer of an input (M66), which is not known here",
            hint="the path must not depend on inputs of the machine",
        )

    parameters.computed[5399] = read
