"""Laser tracker, or any instrument that sees the tool tip all over the work space.

Source: closed form derived here: a rigid pose of the instrument adds t + w x p to every place p.
"""

from dataclasses import replace
from typing import Literal

import numpy as np

from vmach.base.note import Kind, Note, in_file
from vmach.base.units import um_from_mm, urad_from_rad
from vmach.instruments.drawing import end_of_scale
from vmach.instruments.readings import (
    ALONG,
    PLANNED_TOOL_LENGTH_MM,
    doubts_of_stops,
    in_stretches,
    in_three_directions,
    three_directions,
)
from vmach.machine import LINEAR_AXES
from vmach.measurements import Measurement
from vmach.measurements.instrument import Instrument
from vmach.measurements.plausibility.alternatives import BETTER, FAR_BETTER, WITHIN_U
from vmach.measurements.plausibility.motion_check import check_extent, check_travel
from vmach.path.instrument_motion import stop_and_go
from vmach.report.page.svg_plot import Frame, Plot, ticks

__all__ = ["Tip"]


class Tip(Instrument):
    """The tool tip at places all over the volume."""

    name = "tip"
    title = "Tool tip in the work space"
    columns = ("t_s", *"XYZ", "sx", "sy", "sz", *ALONG)
    text_columns = ()
    readings = ALONG
    signs = ("sx", "sy", "sz")
    sign_meaning = "a displacement is that of the tool relative to the workpiece"
    left_free = "offset of the instrument, or its pose"
    abreast = 3
    commonness = 1

    frame: Literal["offset", "rigid"] = "offset"

    def read(self, table, model):
        nose = table.vectors("XYZ")
        check_travel(nose, table, model.travel_mm)
        check_extent(nose, table)
        side = np.sign(table.vectors(self.signs))
        states = stop_and_go(
            nose, table.numbers["t_s"], side=side, tool_length_mm=self.tool_length_mm
        )
        test = three_directions(
            self,
            table,
            states,
            model=model,
            nuisance=_left_free(nose, with_rotation=self.frame == "rigid"),
            notes=doubts_of_stops(nose, side, table, model),
        )
        if self.frame == "rigid":
            return test
        return test.noted(*in_file(_turned_notes(test, nose), table.path))

    @classmethod
    def left_free_by(cls, measurement):
        """Three numbers are an offset, six a pose."""
        return f"{'pose' if measurement.nuisance.shape[1] > 3 else 'offset'} of the instrument"

    @classmethod
    def blocks(cls, measurement):
        return in_stretches(measurement)

    @classmethod
    def plots(cls, curves):
        """Measured against predicted, by component: on the diagonal they agree."""
        end, found = end_of_scale(curves), []
        for k, axis in enumerate(LINEAR_AXES):
            rows = curves.measurement.sensing[:, k] > 0.5
            frame = Frame((-end, end), (-end, end), width=300.0, height=300.0, top=18.0)
            plot = Plot(frame)
            plot.y_axis("measured, µm")
            plot.x_axis("predicted, µm", ticks(-end, end, most=5))
            plot.line(np.array([-end, end]), np.array([-end, end]), "diagonal")
            for state, values in curves.predicted.items():
                plot.dots(values[rows], curves.measured[rows], state)
            words = f"Measured against predicted, component {axis}"
            found.append((f"component {axis}", plot.markup(words)))
        return found

    @classmethod
    def planned(cls, job):
        """Places at random, each approached from a side at random."""
        low, high = job.machine.travel_mm
        random = np.random.default_rng(7)
        nose = random.uniform(low + 0.03 * (high - low), high - 0.03 * (high - low), (120, 3))
        side = random.choice([-1.0, 1.0], (120, 3))
        states = stop_and_go(
            nose, 8.0 * np.arange(120), side=side, tool_length_mm=PLANNED_TOOL_LENGTH_MM
        )
        yield in_three_directions(
            "tip grid",
            "tracker on the tool tip at 120 places all over the work space, each approached from "
            "a stated side",
            {"kind": cls.name, "frame": "rigid"},
            states,
            nuisance=_left_free(nose, with_rotation=True),
            maps_work_space=True,
        )


def _turned_notes(test: Measurement, nose_mm: np.ndarray) -> tuple[Note, ...]:
    """A note where readings of an offset alone agree far better once all of them are turned.

    A machine has to be out of square in six ways to do the same.
    """
    apart = test.measured_mm - test.predicted_mm
    plain = test.variation_mm(apart)
    turned = replace(test, nuisance=_left_free(nose_mm, with_rotation=True))
    left = turned.variation_mm(apart)
    if plain < BETTER * left or left > max(WITHIN_U * float(test.u_mm[0]), plain / FAR_BETTER):
        return ()
    amounts = np.linalg.lstsq(turned.nuisance, apart, rcond=None)[0]
    by = ", ".join(f"{urad_from_rad(value):.0f}" for value in -amounts[3:])
    said = (
        f"turned by ({by}) urad about X, Y, Z the readings agree within {um_from_mm(left):.2f} um "
        f'instead of {um_from_mm(plain):.2f} um (rms): is frame = "rigid" meant, the instrument '
        "not aligned with the axes?"
    )
    return (Note.question(Kind.ALIGNMENT, said, float(um_from_mm(plain)), "um", place="frame"),)


def _left_free(nose_mm: np.ndarray, *, with_rotation: bool) -> np.ndarray:
    """Offset of the instrument, and its rotation about the middle of the places, (3 P, K)."""
    unit = np.tile(np.eye(3), (len(nose_mm), 1))
    if not with_rotation:
        return unit
    arm = np.repeat(nose_mm - nose_mm.mean(axis=0), 3, axis=0)
    return np.hstack([unit, np.cross(arm, unit)])
