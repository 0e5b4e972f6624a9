"""Electronic levels on tool side and table: the tilt of one against the other along an axis.

Source: ISO 230-1, angular error motions of a linear axis, by levels.
"""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from vmach.files.toml_file import Point
from vmach.instruments.line_plots import line_plots
from vmach.instruments.readings import (
    PLANNED_TOOL_LENGTH_MM,
    doubts_of_stops,
    one_a_stop,
)
from vmach.machine import LINEAR_AXES
from vmach.measurements.instrument import Instrument, PlannedTest
from vmach.measurements.plausibility.motion_check import check_extent, check_travel
from vmach.path.instrument_motion import stop_and_go

__all__ = ["Level"]

#: a tilt of 1 urad moves one end of the arm by 1 um against the other
_ARM_MM = 1000.0
#: of the arm, and of the motion that is seen: right-handed about X, about Y; a level feels no more
_ARM = {"A": (LINEAR_AXES.index("Y"), LINEAR_AXES.index("Z")),
        "B": (LINEAR_AXES.index("Z"), LINEAR_AXES.index("X"))}  # fmt: skip


class Level(Instrument):
    """Tilts along one axis, from both sides (ISO 230-1: angular error motions, by levels)."""

    name = "level"
    title = "Level"
    columns = ("run", "position_mm", "approach", "tilt_um_per_m")
    optional_columns = ("t_s",)
    has_runs = True
    readings = ("tilt_um_per_m",)
    signs = ("approach",)
    sign_meaning = (
        "tilt_um_per_m is positive where the tool is turned right-handed about X (A) or Y (B)"
    )
    left_free = "zero"
    shows_law_band = True

    axis: Literal["X", "Y", "Z"]
    about: Literal["A", "B"]
    at_mm: Point

    def mistaken(self) -> Iterator[dict[str, Any]]:
        """The axis that moved, or the one that the level turns about."""
        yield from ({"axis": axis} for axis in "XYZ" if axis != self.axis)
        yield from ({"about": about} for about in _ARM if about != self.about)

    def read(self, table, model):
        axis = LINEAR_AXES.index(self.axis)
        nose = np.tile(self.at_mm, (len(table.lines), 1))
        nose[:, axis] = table.numbers["position_mm"]
        check_travel(nose, table, model.travel_mm)
        check_extent(nose, table)
        side = np.zeros_like(nose)
        side[:, axis] = np.sign(table.numbers["approach"])
        states, sensing = _tilts(
            nose, table.numbers["t_s"], side, about=self.about, tool_length_mm=self.tool_length_mm
        )
        notes = doubts_of_stops(nose, side, table, model)
        return one_a_stop(self, table, states, sensing, model=model, notes=notes)

    @classmethod
    def plots(cls, curves):
        moved = np.ptp(curves.path.nose_mm, axis=0)
        return tuple(line_plots(curves, np.eye(3)[int(np.argmax(moved))], unit="µm/m"))

    @classmethod
    def planned(cls, job):
        low, high = job.machine.travel_mm
        for axis, about in ((axis, about) for axis in LINEAR_AXES for about in _ARM):
            yield _line_through_the_middle(axis, about, low, high)


def _tilts(nose_mm, time_s, side, *, about, tool_length_mm):
    """States whose tilt about an axis is read, and the directions in which it shows."""
    states = stop_and_go(nose_mm, time_s, side=side, tool_length_mm=tool_length_mm)
    arm, seen = (np.tile(np.eye(3)[k], (len(nose_mm), 1)) for k in _ARM[about])
    return replace(states, arm_mm=_ARM_MM * arm), seen


def _line_through_the_middle(
    axis: str, about: str, low: np.ndarray, high: np.ndarray
) -> PlannedTest:
    """One axis through the middle of the others, both ways."""
    k, middle = LINEAR_AXES.index(axis), 0.5 * (low + high)
    margin = 0.05 * (high[k] - low[k])
    out = np.linspace(low[k] + margin, high[k] - margin, 30)
    nose = np.tile(middle, (2 * len(out), 1))
    nose[:, k] = np.concatenate([out, out[::-1]])
    side = np.zeros_like(nose)
    side[:, k] = np.repeat([1.0, -1.0], len(out))
    states, sensing = _tilts(
        nose, 10.0 * np.arange(len(nose)), side, about=about, tool_length_mm=PLANNED_TOOL_LENGTH_MM
    )
    around = "XY"["AB".index(about)]
    return PlannedTest(
        f"level {axis} {about}",
        f"level on tool side and table along {axis}, about {around}, both ways",
        {"kind": Level.name, "axis": axis, "about": about, "at_mm": middle},
        states,
        sensing,
        np.ones((len(nose), 1)),
    )
