"""Probe nest at one place of the work space, against time: warm spindle, weather.

Source: ISO 230-3, tests of environmental temperature variation and of the rotating spindle.
"""

import numpy as np

from vmach.base.note import in_file
from vmach.files.toml_file import Point
from vmach.instruments.drawing import against, end_of_scale
from vmach.instruments.readings import (
    ALONG,
    PLANNED_TOOL_LENGTH_MM,
    in_stretches,
    in_three_directions,
    three_directions,
)
from vmach.machine import LINEAR_AXES
from vmach.measurements.instrument import Instrument
from vmach.measurements.plausibility.motion_check import check_travel
from vmach.measurements.plausibility.motion_doubts import drift_notes
from vmach.path.instrument_motion import stop_and_go

__all__ = ["Drift"]


class Drift(Instrument):
    """The tool tip at one place against time (ISO 230-3)."""

    name = "drift"
    title = "Drift test"
    columns = ("t_s", "spindle_rpm", *ALONG)
    text_columns = ()
    readings = ALONG
    has_sensors = True
    sign_meaning = "a displacement is that of the tool relative to the workpiece"
    left_free = "zero"
    abreast = 3
    shows_law_band = True
    commonness = 2

    at_mm: Point

    def read(self, table, model):
        time = table.numbers["t_s"]
        nose = np.tile(self.at_mm, (len(time), 1))
        check_travel(nose, table, model.travel_mm)
        states = stop_and_go(
            nose,
            time,
            side=np.zeros((len(time), 3)),
            tool_length_mm=self.tool_length_mm,
            rpm=table.numbers["spindle_rpm"],
        )
        zero = np.tile(np.eye(3), (len(time), 1))
        notes = in_file(drift_notes(time), table.path)
        return three_directions(self, table, states, model=model, nuisance=zero, notes=notes)

    @classmethod
    def blocks(cls, measurement):
        return in_stretches(measurement)

    @classmethod
    def plots(cls, curves):
        """Each direction against time."""
        minutes, end = curves.path.time_s / 60, end_of_scale(curves)
        return [
            (
                f"tool tip in {axis}",
                against(curves, curves.measurement.sensing[:, k] > 0.5, minutes, "time, min", end),
            )
            for k, axis in enumerate(LINEAR_AXES)
            if (curves.measurement.sensing[:, k] > 0.5).any()
        ]

    @classmethod
    def planned(cls, job):
        """The tool tip while the spindle warms, cools, and warms again."""
        low, high = job.machine.travel_mm
        middle = 0.5 * (low + high)
        time = np.arange(0.0, 9000.0, 60.0)
        rpm = np.where(time < 3600.0, 8000.0, np.where(time < 6300.0, 0.0, 4000.0))
        states = stop_and_go(
            np.tile(middle, (len(time), 1)),
            time,
            side=np.zeros((len(time), 3)),
            tool_length_mm=PLANNED_TOOL_LENGTH_MM,
            rpm=rpm,
        )
        yield in_three_directions(
            cls.name,
            "drift test: probe nest on the table, spindle 60 min at 8000 rpm, 45 min standing, "
            "45 min at 4000 rpm, axes still",
            {"kind": cls.name, "at_mm": middle},
            states,
            nuisance=np.tile(np.eye(3), (len(time), 1)),
        )
