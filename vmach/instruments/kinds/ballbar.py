"""Ballbar: circles about a centre, both ways round.

Source: ISO 230-4, circular tests for numerically controlled machine tools.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
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
    turns = True
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
        states = circles(circle, angle, table, group=group)
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
        for arc in _ARCS:
            yield _planned_arcs(arc, *job.machine.travel_mm)


@dataclass(frozen=True)
class _Arc:
    """An arc in a plane that a test can run: angles from its first axis towards the second.

    Attributes
    ----------
    plane : str
    first_deg : tuple of float
        Where the way up and the way back begin.
    run_up_deg, read_deg, run_out_deg : float
    words : str
        How much of a circle is read.
    """

    plane: Literal["XY", "YZ", "ZX"]
    first_deg: tuple[float, float]
    run_up_deg: float
    read_deg: float
    run_out_deg: float
    words: str = ""

    @property
    def sweep_rad(self) -> float:
        """All of it."""
        return np.radians(self.run_up_deg + self.read_deg + self.run_out_deg)


#: whole circles in XY, after half a turn, in which both axes reverse; above the table arcs of 220
#: degrees, of which 180 are read: spindle and centre mount leave no room for more (ISO 230-4
#: allows partial arcs)
_ARCS = (
    _Arc("XY", (0.0, 0.0), 180.0, 360.0, 0.0),
    _Arc("YZ", (-20.0, 200.0), 20.0, 180.0, 20.0, ", 180 degrees above the centre"),
    _Arc("ZX", (-110.0, 110.0), 20.0, 180.0, 20.0, ", 180 degrees above the centre"),
)


def _planned_arcs(arc: _Arc, low: np.ndarray, high: np.ndarray) -> PlannedTest:
    """An arc at two feeds, both ways round."""
    axes = [LINEAR_AXES.index(axis) for axis in arc.plane]
    across, upward = np.eye(3)[axes]
    radius = min(150.0, 0.4 * float((high - low)[axes].min()))
    circle = Circle(0.5 * (low + high), across, upward, radius, PLANNED_TOOL_LENGTH_MM)
    record = MotionRecord(circle.centre_mm, tool_length_mm=PLANNED_TOOL_LENGTH_MM)
    way = np.radians(arc.run_up_deg + np.arange(0.5, arc.read_deg, 2.0))
    moves, angles, clock = [], [], 10.0
    for feed, (turn, first_deg) in itertools.product(
        (1000.0, 4000.0), zip((1.0, -1.0), arc.first_deg, strict=True)
    ):
        first, duration = np.radians(first_deg), arc.sweep_rad * radius / feed * 60.0
        if np.allclose(record.nose_mm, circle.at(first)):
            record.stand(until_s=clock)
        else:
            record.line(circle.at(first), until_s=clock)
        move = record.arc(
            circle.at(first + turn * arc.sweep_rad),
            centre_mm=circle.centre_mm,
            axis=np.cross(across, upward),
            sweep_rad=turn * arc.sweep_rad,
            until_s=clock + duration,
        )
        clock += duration + 10.0
        moves.append(np.full(len(way), move))
        angles.append(first + turn * way)
    angle = np.concatenate(angles)
    return PlannedTest(
        f"ballbar {arc.plane}",
        f"ballbar in {arc.plane}{arc.words}, radius {radius:.0f} mm, both ways at 1000 and "
        "4000 mm/min",
        {
            "kind": Ballbar.name,
            "plane": arc.plane,
            "centre_mm": circle.centre_mm,
            "radius_mm": radius,
        },
        record.states(np.concatenate(moves), np.tile(way / arc.sweep_rad, len(moves))),
        circle.outward(angle),
        np.column_stack([np.ones(len(angle)), np.cos(angle), np.sin(angle)]),
    )
