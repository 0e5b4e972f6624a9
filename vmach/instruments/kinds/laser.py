"""Laser interferometer along one axis.

Source: ISO 230-2, positioning deviations along one axis from both sides; ISO 230-1 for
straightness.
"""

from collections.abc import Iterator
from typing import Any, Literal

import numpy as np

from vmach.base.note import in_file
from vmach.files.toml_file import NonNegative, Point
from vmach.instruments.line_plots import line_plots
from vmach.instruments.readings import (
    PLANNED_TOOL_LENGTH_MM,
    along_line,
)
from vmach.machine import LINEAR_AXES
from vmach.measurements.instrument import Instrument, PlannedTest
from vmach.measurements.plausibility.motion_doubts import lost_motion_notes
from vmach.path.instrument_motion import stop_and_go

__all__ = ["Laser"]


class Laser(Instrument):
    """Positions of one axis, from both sides (ISO 230-2)."""

    name = "laser"
    title = "Laser line"
    columns = ("run", "position_mm", "approach", "deviation_um")
    optional_columns = ("t_s",)
    has_runs = True
    readings = ("deviation_um",)
    signs = ("approach",)
    sign_meaning = "deviation_um is positive where the tool is further along + than programmed"
    left_free = "zero"
    results = ("backlash {axis}",)  # ISO 230-2, reversal value of an axis
    defines = ("component E{axis}{axis}",)  # ISO 230-1, positioning error motion
    shows_law_band = True
    commonness = 4

    axis: Literal["X", "Y", "Z"]
    at_mm: Point
    scale_u_ppm: NonNegative | None = None

    def mistaken(self) -> Iterator[dict[str, Any]]:
        """Also the axis that moved."""
        yield from super().mistaken()
        yield from ({"axis": axis} for axis in "XYZ" if axis != self.axis)

    def read(self, table, model):
        axis = LINEAR_AXES.index(self.axis)
        nose = np.tile(self.at_mm, (len(table.lines), 1))
        nose[:, axis] = table.numbers["position_mm"]
        scale_u, direction = self.scale_u_ppm, np.eye(3)[axis]
        test = along_line(self, table, nose, direction=direction, scale_u_ppm=scale_u, model=model)
        if test.notes:
            return test
        return test.noted(*in_file(lost_motion_notes(test, table.numbers["approach"]), table.path))

    @classmethod
    def plots(cls, curves):
        return tuple(line_plots(curves, curves.measurement.sensing[0]))

    @classmethod
    def planned(cls, job):
        low, high = job.machine.travel_mm
        for k in range(len(LINEAR_AXES)):
            yield _line_through_the_middle(k, low, high)


def _line_through_the_middle(k: int, low: np.ndarray, high: np.ndarray) -> PlannedTest:
    """One axis through the middle of the others."""
    axis, middle = LINEAR_AXES[k], 0.5 * (low + high)
    margin = 0.05 * (high[k] - low[k])
    steps = np.linspace(low[k] + margin, high[k] - margin, 30)
    fine = 0.5 * (low[k] + high[k]) + np.arange(0.0, 40.0, 1.3)
    out = np.sort(np.concatenate([steps, fine]))
    ways = np.concatenate([out, out[::-1]] * 3)
    nose = np.tile(middle, (len(ways), 1))
    nose[:, k] = ways
    side = np.zeros_like(nose)
    side[:, k] = np.concatenate([np.ones(len(out)), -np.ones(len(out))] * 3)
    states = stop_and_go(
        nose, 5.0 * np.arange(len(ways)), side=side, tool_length_mm=PLANNED_TOOL_LENGTH_MM
    )
    return PlannedTest(
        f"laser {axis}",
        f"laser line along {axis}, both ways three times, with fine steps in the middle",
        {"kind": Laser.name, "axis": axis, "at_mm": middle},
        states,
        np.tile(np.eye(3)[k], (len(ways), 1)),
        np.ones((len(ways), 1)),
    )
