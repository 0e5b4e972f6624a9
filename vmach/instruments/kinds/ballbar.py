"""Ballbar: circles about a centre, both ways round.

Source: ISO 230-4, circular tests for numerically controlled machine tools.
"""

import itertools
from collections.abc import Iterator
from typing import Any, Literal

import numpy as np

from vmach.base.note import in_file
from vmach.base.units import mm_from_um
from vmach.files.toml_file import Point, Positive
from vmach.instruments.circle_plots import circle_plots
from vmach.instruments.readings import PLANNED_TOOL_LENGTH_MM
from vmach.machine import LINEAR_AXES
from vmach.measurements import Measurement
from vmach.measurements.ballbar_motion import Circle, circles
from vmach.measurements.instrument import Instrument, PlannedTest
from vmach.measurements.plausibility.motion_check import check_feed, check_travel
from vmach.measurements.plausibility.motion_doubts import circle_notes
from vmach.path.instrument_motion import MotionRecord

__all__ = ["Ballbar"]


class Ballbar(Instrument):
    """Circles about a centre, both ways round (ISO 230-4)."""

    name = "ballbar"
    title = "Ballbar"
    columns = ("run", "feed_mm_min", "angle_deg", "t_s", "radius_um")
    readings = ("radius_um",)
    sign_meaning = "radius_um is positive where the tool is further out than programmed"
    left_free = "radius and centre"
    abreast = 3
    commonness = 3

    plane: Literal["XY", "YZ", "ZX", "XZ", "YX", "ZY"] = "XY"
    centre_mm: Point
    radius_mm: Positive

    def mistaken(self) -> Iterator[dict[str, Any]]:
        """Also the plane: which of its axes angles count from."""
        yield from super().mistaken()
        yield {"plane": self.plane[::-1]}

    def read(self, table, model):
        across, upward = (np.eye(3)[LINEAR_AXES.index(axis)] for axis in self.plane)
        circle = Circle(
            np.array(self.centre_mm), across, upward, self.radius_mm, self.tool_length_mm
        )
        angle, feed = np.radians(table.numbers["angle_deg"]), table.numbers["feed_mm_min"]
        group = np.char.add(np.char.add(table.text["run"], " "), feed.astype(str))
        states = circles(circle, angle, table.numbers["t_s"], group=group, path=table.path)
        out = circle.outward(angle)
        check_feed(table, group, self.radius_mm)
        check_travel(circle.centre_mm + circle.radius_mm * out, table, model.travel_mm)
        return Measurement(
            instrument=type(self),
            name=table.path.name,
            id=np.arange(1, len(out) + 1).astype(str),
            states=states,
            sensing=out,
            measured_mm=mm_from_um(table.numbers["radius_um"]),
            predicted_mm=model.predicted_mm(states, out),
            u_mm=np.full(len(out), mm_from_um(self.u_um)),
            group=group,
            nuisance=np.column_stack([np.ones(len(out)), np.cos(angle), np.sin(angle)]),
            notes=in_file(circle_notes(table.text["run"], angle, self.plane), table.path),
        )

    @classmethod
    def plots(cls, curves):
        return tuple(circle_plots(curves))

    @classmethod
    def planned(cls, job):
        yield _circles_in_xy(*job.machine.travel_mm)


def _circles_in_xy(low: np.ndarray, high: np.ndarray) -> PlannedTest:
    """Circles at two feeds, both ways round."""
    middle, radius = 0.5 * (low + high), min(150.0, 0.4 * float((high - low)[:2].min()))
    start = middle + np.array([radius, 0.0, 0.0])
    record = MotionRecord(middle, tool_length_mm=PLANNED_TOOL_LENGTH_MM)
    angle = np.radians(np.arange(0.5, 360.0, 2.0))
    moves, out, clock = [], [], 10.0
    for feed, turn in itertools.product((1000.0, 4000.0), (1.0, -1.0)):
        duration = 2 * np.pi * radius / feed * 60.0
        record.line(start, until_s=clock)
        # a turn and a half, so that the axes have reversed before the readings begin
        move = record.arc(
            2 * middle - start,
            centre_mm=middle,
            axis=np.array([0.0, 0.0, 1.0]),
            sweep_rad=turn * 3 * np.pi,
            until_s=clock + 1.5 * duration,
        )
        clock += 1.5 * duration + 10.0
        moves.append(np.full(len(angle), move))
        facing = turn * (np.pi + angle)
        out.append(np.column_stack([np.cos(facing), np.sin(facing), 0 * facing]))
    sensing = np.vstack(out)
    places = np.tile((np.pi + angle) / (3 * np.pi), len(moves))
    return PlannedTest(
        "ballbar XY",
        f"ballbar in XY, radius {radius:.0f} mm, both ways at 1000 and 4000 mm/min",
        {"kind": Ballbar.name, "plane": "XY", "centre_mm": middle, "radius_mm": radius},
        record.states(np.concatenate(moves), places),
        sensing,
        np.column_stack([np.ones(len(sensing)), sensing[:, :2]]),
    )
