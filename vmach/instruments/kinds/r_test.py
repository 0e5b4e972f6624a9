"""R-test: where a sphere on the table is found at several angles of the rotary axes.

Source: ISO 10791-6, kinematic tests of five-axis machines with a sphere and three sensors; closed
form derived here: the sphere keeps its place on the workpiece, and the linear axes follow it.
"""

import numpy as np

from vmach.errors import InputError
from vmach.files.toml_file import Point
from vmach.instruments.drawing import against, end_of_scale
from vmach.instruments.readings import ALONG, doubts_of_stops, in_stretches, three_directions
from vmach.machine import LINEAR_AXES
from vmach.machine.chain import ROTARY_AXES
from vmach.machine.machine_axes import workpiece_pose
from vmach.machine.nominal_motion import tip_on_workpiece
from vmach.measurements.instrument import Instrument
from vmach.measurements.plausibility.motion_check import check_travel
from vmach.path.instrument_motion import stop_and_go

__all__ = ["RTest"]

#: columns of the angles, deg, in the order of A, B, C
_ANGLES = tuple(f"{axis}_deg" for axis in ROTARY_AXES)
#: effects that it measures: across each axis, the next direction and the one after it
_RESULTS = tuple(
    f"{effect} {kinds[(k + step) % 3]}0{axis}"
    for k, axis in enumerate(ROTARY_AXES)
    for effect, kinds in (("rotary_location", "XYZ"), ("rotary_tilt", "ABC"))
    for step in (1, 2)
)
#: rounding of angles at the ends of the travel
_ROUNDING_DEG = 1e-6


class RTest(Instrument):
    """A sphere on the table against sensors, or a probe, in the spindle (ISO 10791-6, R-test)."""

    name = "r_test"
    title = "R-test"
    columns = ("t_s", *ALONG)
    optional_columns = _ANGLES
    text_columns = ()
    readings = ALONG
    sign_meaning = (
        "a displacement is that of the tool relative to the sphere, along X, Y, Z of the machine"
    )
    left_free = "place of the sphere"
    has_sensors = True
    # ISO 230-7: location errors are those of the line to which the linear axes were set
    results = _RESULTS
    abreast = 3
    shows_law_band = True

    sphere_mm: Point

    def read(self, table, model):
        machine = model.machine
        angle_deg = _angles_deg(table, machine)
        nose = _following(machine, self.sphere_mm, np.radians(angle_deg), self.tool_length_mm)
        check_travel(nose, table, model.travel_mm)
        still = np.zeros_like(nose)
        states = stop_and_go(
            nose, table.numbers["t_s"], side=still, tool_length_mm=self.tool_length_mm,
            rotary_deg=angle_deg,
        )  # fmt: skip
        pose = workpiece_pose(machine, nose, np.radians(angle_deg))
        free = [pose.vectors_to_bed(np.tile(unit, (len(nose), 1))) for unit in np.eye(3)]
        return three_directions(
            self,
            table,
            states,
            model=model,
            nuisance=np.stack(free, axis=2).reshape(-1, 3),
            notes=doubts_of_stops(nose, still, table, model),
        )

    @classmethod
    def blocks(cls, measurement):
        return in_stretches(measurement)

    @classmethod
    def plots(cls, curves):
        """Each direction against each angle that turned."""
        end, found = end_of_scale(curves), []
        angle_deg = np.degrees(curves.path.rotary_rad)
        for j in np.flatnonzero(np.ptp(angle_deg, axis=0)):
            for k, axis in enumerate(LINEAR_AXES):
                rows = curves.measurement.sensing[:, k] > 0.5
                if rows.any():
                    name = f"{ROTARY_AXES[j]}, deg"
                    drawn = against(curves, rows, angle_deg[:, j], name, end)
                    found.append((f"along {axis} over {ROTARY_AXES[j]}", drawn))
        return found


def _angles_deg(table, machine) -> np.ndarray:
    """Angles of A, B, C at every reading, (P, 3); zero of those without a column."""
    given = [name for name in _ANGLES if name in table.numbers]
    own = [f"{axis}_deg" for axis in machine.chain.rotary_axes]
    if not given or not set(given) <= set(own):
        raise InputError(
            f"angles of {', '.join(given) or 'no axis'}",
            file=table.path,
            line=1,
            accepted=f"columns of rotary axes of the machine: {', '.join(own) or 'it has none'}",
        )
    angle = np.zeros((len(table.lines), 3))
    for name in given:
        k = _ANGLES.index(name)
        angle[:, k] = table.numbers[name]
        axis = machine.rotary[ROTARY_AXES[k]]
        low, high = np.degrees([axis.travel_min_rad, axis.travel_max_rad])
        outside = (angle[:, k] < low - _ROUNDING_DEG) | (angle[:, k] > high + _ROUNDING_DEG)
        if outside.any():
            raise InputError(
                f"{name} is {angle[outside, k][0]:g}",
                file=table.path,
                line=table.line_of(outside),
                accepted=f"the travel, {low:g} .. {high:g} deg",
            )
    return angle


def _following(machine, sphere_mm, rotary_rad, tool_length_mm: float) -> np.ndarray:
    """Positions of X, Y, Z at which the nominal tip is at the sphere, (P, 3) mm.

    The tip on the workpiece is linear in the positions, whatever the angles are.
    """
    tool = np.array([0.0, 0.0, -tool_length_mm])
    home = np.zeros_like(rotary_rad)
    at_home = tip_on_workpiece(machine, home, tool, rotary_rad)
    slope = np.stack(
        [tip_on_workpiece(machine, home + unit, tool, rotary_rad) - at_home for unit in np.eye(3)],
        axis=2,
    )
    away = np.asarray(sphere_mm) - at_home
    return np.linalg.solve(slope, away[:, :, None])[:, :, 0]
