"""The path of the tool's centre at one block of cutter compensation, and points of its plane.

Source: LinuxCNC, Cutter Compensation; closed form derived here: an offset line or arc is parallel
at the radius.
"""

from __future__ import annotations

import math

from gcode.geometry.arcs import Point
from gcode.state.compensation_queue import WaitingMove
from gcode.state.controller import PLANE_AXES, XZ, Controller
from gcode.state.record import Call

__all__ = ["HALF", "LEFT", "QUARTER", "RIGHT", "CompensatedPath", "beside", "direction", "distance"]

#: `Controller.side`
LEFT, RIGHT = 1, -1
#: half a turn and a quarter of one, rad
HALF, QUARTER = math.pi, math.pi / 2.0


class CompensatedPath:
    """The compensated path at one block: where it stands and how it goes on."""

    def __init__(self, controller: Controller, end: list[float]) -> None:
        self.controller, self.queue = controller, controller.queue
        self.first, self.second, self.axial = PLANE_AXES[controller.plane]
        self.side, self.radius = controller.side, controller.radius
        self.unit_mm = controller.unit_mm
        self.full_end = end
        self.current = self._plane(controller.position)
        self.level = controller.position[self.axial]
        self.programmed = self._plane(controller.programmed)
        self.end = self._plane(end)

    def goes_straight(self, turn: float) -> bool:
        """Whether an outer corner of this turn (rad) is passed by lines, not by an arc."""
        return bool(self.controller.start_up) and turn < self.controller.round_corners_from

    def _plane(self, position: list[float]) -> Point:
        return position[self.first], position[self.second]

    def _tool_point(self, point: Point) -> Point:
        """Shift from the centre of a lathe tool's nose to its controlled point."""
        c = self.controller
        if c.plane != XZ:
            return point
        z = {1: 1, 4: 1, 5: 1, 2: -1, 3: -1, 7: -1}.get(c.orientation, 0)
        x = {3: 1, 4: 1, 8: 1, 1: -1, 2: -1, 6: -1}.get(c.orientation, 0)
        return point[0] + z * c.radius, point[1] + x * c.radius

    def position(self, point: Point, level: float) -> list[float]:
        """X Y Z A B C of a point of the plane."""
        result = list(self.full_end)
        result[self.first], result[self.second] = self._tool_point(point)
        result[self.axial] = level
        return result

    def add_line(self, call: Call, end: Point, direction: Point, *, level: float) -> None:
        """Let a straight move wait."""
        controller, line = self.controller, self.controller.line

        def issue(final: Point) -> None:
            controller.record.straight(call, self.scaled(final, level), line=line)

        name = "Straight feed" if call is Call.FEED else "Straight traverse"
        self.queue.items.append(WaitingMove(name, end, issue, direction))

    def add_arc(
        self, end: Point, centre: Point, turns: int, *, level: float, angle: float = 0.0
    ) -> None:
        """Let an arc wait."""
        controller, line = self.controller, self.controller.line
        move = WaitingMove("Arc move", end, lambda _: None, (0.0, 0.0), centre, turns, angle)

        def issue(final: Point) -> None:
            position = self.scaled(final, level)
            middle = self._tool_point(move.centre)
            numbers = (position[self.first], position[self.second], *middle, turns,
                       position[self.axial])  # fmt: skip
            controller.record.arc(controller.plane, numbers, position=position, line=line)

        move.issue = issue
        self.queue.items.append(move)

    def scaled(self, final: Point, level: float) -> list[float]:
        """Position for the record where G20 or G21 has changed the unit in between."""
        position = self.position(final, level)
        factor = self.unit_mm / self.controller.unit_mm
        if factor != 1.0:
            for axis in range(3):
                if axis not in (self.first, self.second):
                    position[axis] *= factor
        return position

    def release_to(self, point: Point) -> None:
        """Settle the waiting moves at `point`."""
        self.queue.release_to(point, unit_mm=self.unit_mm)

    def release(self) -> None:
        """Settle the waiting moves as they are, the path going on from the present point."""
        self.queue.release()
        self.queue.start = self.current

    def finish(self, end: Point) -> None:
        """Make `end` the compensated and the block's end the programmed position."""
        controller = self.controller
        position = list(self.full_end)
        position[self.first], position[self.second] = end
        controller.position = position
        controller.programmed = list(self.full_end[:3])
        controller.entering = False

    def inside(self, turns: int) -> bool:
        """Tell whether the tool runs on the inside of an arc."""
        return (turns > 0) == (self.side == LEFT)


def beside(point: Point, radius: float, angle: float) -> Point:
    """Point at a distance from another, in the direction of an angle."""
    return point[0] + radius * math.cos(angle), point[1] + radius * math.sin(angle)


def direction(start: Point, end: Point) -> float:
    """Angle of the way from one point to another, rad."""
    return math.atan2(end[1] - start[1], end[0] - start[0])


def distance(a: Point, b: Point) -> float:
    """Distance of two points."""
    return math.hypot(b[0] - a[0], b[1] - a[1])
