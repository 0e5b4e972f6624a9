"""G40-G42: the path of the tool's centre beside the programmed contour.

The end of each compensated move waits (`compensation_queue`) until the next move shows which
kind of corner it makes: tangent, convex (an arc about the corner) or concave (both moves are
cut back to where the offset curves meet). A concave corner that the tool cannot reach is
refused. Coordinates are those of the plane: first, second, axial.
"""

from __future__ import annotations

import math

from gcode.arc_words import arc_centre
from gcode.arcs import Point, arc_angle, arc_length
from gcode.block_values import Values, whole
from gcode.compensation_queue import WaitingMove
from gcode.errors import ProgramError
from gcode.feed import set_inverse_time_feed
from gcode.record import Call
from gcode.state import PLANE_AXES, XY, XZ, Controller

__all__ = ["arc", "flush", "straight", "switch"]

_LEFT, _RIGHT = 1, -1
#: Corners that turn less than this count as tangent, rad.
_TANGENT = 0.05
_HALF, _QUARTER = math.pi, math.pi / 2.0


def switch(controller: Controller, block: Values, code: int) -> None:
    """Obey G40, G41, G42, G41.1, G42.1."""
    if code == 400:
        _cancel(controller)
        return
    name = f"G{code // 10}"
    if controller.plane not in (XY, XZ):
        raise ProgramError(f"{name} in plane G19", accepted="G17 or G18")
    if controller.side:
        raise ProgramError(f"{name} with cutter compensation already on", hint="G40 first")
    diameter, orientation = _cutter(controller, block, code)
    side = _LEFT if code in (410, 411) else _RIGHT
    controller.side = -side if diameter < 0.0 else side
    controller.radius = abs(diameter) / 2.0
    controller.orientation = orientation
    controller.note(name, "cutter compensation on") if controller.radius == 0.0 else None


def _cutter(controller: Controller, block: Values, code: int) -> tuple[float, int]:
    """Diameter in program units and lathe orientation."""
    words, name = block.words, f"G{code // 10}"
    if code in (411, 421):
        if "d" not in words:
            raise ProgramError(f"{name}.1 without D word", accepted="D with the diameter")
        if "l" in words and controller.plane != XZ:
            raise ProgramError(f"{name}.1 with L word outside G18")
        return words["d"], int(words.get("l", 0.0))
    number = whole(words["d"], f"D word of {name}") if "d" in words else controller.loaded
    if number < 0:
        raise ProgramError(f"negative D word D{number}")
    entry = controller.find_tool(number, word="D" if "d" in words else f"{name} with tool T")
    if controller.plane != XZ and entry.orientation not in (0, 9):
        raise ProgramError(f"{name} with a lathe tool outside G18")
    return entry.diameter_mm / controller.unit_mm, entry.orientation


def flush(controller: Controller) -> None:
    """Say everything that waits, ending where the compensated path stands."""
    if controller.queue.items:
        first, second, _ = PLANE_AXES[controller.plane]
        here = (controller.position[first], controller.position[second])
        controller.queue.release_to(here, unit_mm=controller.unit_mm)
    controller.queue.release()


def _cancel(controller: Controller) -> None:
    if controller.side and controller.radius > 0.0 and not controller.entering:
        flush(controller)
        controller.position[:3] = controller.programmed
        controller.straight_only = True
    controller.side = 0
    controller.entering = True


class _Path:
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
        return (turns > 0) == (self.side == _LEFT)


def _beside(point: Point, radius: float, angle: float) -> Point:
    return point[0] + radius * math.cos(angle), point[1] + radius * math.sin(angle)


def _direction(start: Point, end: Point) -> float:
    return math.atan2(end[1] - start[1], end[0] - start[0])


def _distance(a: Point, b: Point) -> float:
    return math.hypot(b[0] - a[0], b[1] - a[1])


def straight(controller: Controller, motion: int, end: list[float]) -> None:
    """G0 and G1 with compensation on."""
    path = _Path(controller, end)
    call = Call.FEED if motion == 10 else Call.TRAVERSE
    level = end[path.axial]
    if controller.entering:
        if _distance(path.current, path.end) <= path.radius:
            raise ProgramError("entry move of cutter compensation is not longer than the tool "
                               f"radius {path.radius:g}", hint="start further away")
        angle = _direction(path.current, path.end) + path.side * _QUARTER
        target = _beside(path.end, path.radius, angle)
        path.queue.start = path.current
        path.add_line(call, target, (math.cos(angle), math.sin(angle)), level=level)
        path.finish(target)
        return
    along = (path.end[0] - path.programmed[0], path.end[1] - path.programmed[1])
    if along == (0.0, 0.0):
        path.add_line(call, path.current, along, level=level)
        path.finish(path.current)
        return
    heading = math.atan2(along[1], along[0])
    target = _beside(path.end, path.radius, heading + path.side * _QUARTER)
    _corner_before_line(path, call, heading)
    path.add_line(call, target, along, level=level)
    path.finish(target)


def _corner_before_line(path: _Path, call: Call, heading: float) -> None:
    """Settle the end of the move before a straight one."""
    theta = _direction(path.programmed, path.current)
    turn = (theta - heading) * path.side
    if turn < 0.0:
        turn += 2.0 * math.pi
    beta = turn - _QUARTER
    before = path.queue.first
    into_arc = before is not None and before.turns * path.side < 0
    if beta < -_TANGENT or beta > _HALF + _TANGENT or (beta > _HALF - _TANGENT and into_arc):
        if before is not None and before.turns:
            path.release_to(_line_after_arc(path, before, heading))
        else:
            path.release_to(_line_after_line(path, beta, theta))
    elif beta > _TANGENT:
        path.release_to(path.current)
        middle = _beside(path.programmed, path.radius, heading + path.side * _QUARTER)
        if call is Call.FEED:
            path.add_arc(middle, path.programmed, -path.side, level=path.level)
        else:
            path.add_line(call, middle, (0.0, 0.0), level=path.level)
        path.queue.release()
        path.queue.start = middle
    else:
        path.release()


def _line_after_line(path: _Path, beta: float, theta: float) -> Point:
    """Concave corner of two lines: both are cut back by the same length."""
    half_corner = (beta + _HALF) / 2.0
    if half_corner == 0.0:
        raise ProgramError("inside corner of zero degrees with cutter compensation on")
    retreat = path.radius / math.tan(half_corner)
    return _beside(path.current, retreat, theta + path.side * _QUARTER)


def _line_after_arc(path: _Path, arc_before: WaitingMove, heading: float) -> Point:
    """Concave corner of an arc and a line: where the offset line cuts the offset arc."""
    centre, ccw = arc_before.centre, arc_before.turns > 0
    radius = _distance(centre, arc_before.end)
    inside = path.inside(arc_before.turns)
    contour_radius = radius + path.radius if inside else radius - path.radius
    theta = heading + (_QUARTER if ccw else -_QUARTER)
    depth = contour_radius * math.cos(theta - _direction(path.programmed, centre))
    depth += -path.radius if inside else path.radius
    ratio = depth / radius if radius else math.inf
    if abs(ratio) > 1.0:
        raise ProgramError("arc to straight motion makes a corner the compensated tool can't fit "
                           "in without gouging", hint="use a smaller tool")
    swing = math.acos(ratio) if ccw != inside else -math.acos(ratio)
    return _beside(centre, radius, theta + _HALF + swing)


def arc(controller: Controller, block: Values, end: list[float]) -> None:
    """G2 and G3 with compensation on.

    Parameters
    ----------
    controller : Controller
        State before the block.
    block : Values
        Its words.
    end : list of float
        Programmed end X Y Z A B C.
    """
    path = _Path(controller, end)
    if controller.entering:
        _entry_arc(path, block)
    else:
        _following_arc(path, block)


def _set_feed(path: _Path, block: Values, start: Point, *, centre: Point, turns: int,
              rise: float) -> None:  # fmt: skip
    length = arc_length(start, path.end, centre, turns=turns, rise=rise)
    set_inverse_time_feed(path.controller, block, length)


def _entry_arc(path: _Path, block: Values) -> None:
    """First compensated move: an arc from the present point tangent to the offset contour."""
    if _distance(path.current, path.end) <= path.radius:
        raise ProgramError("entry arc of cutter compensation is not larger than the tool radius "
                           f"{path.radius:g}")
    centre, turns = arc_centre(path.controller, block, path.current, path.end)
    inside = path.inside(turns)
    size = abs(block.words["r"]) if "r" in block.words else _distance(centre, path.current)
    if inside and size <= path.radius:
        raise ProgramError(f"tool radius {path.radius:g} is not less than arc radius {size:g}")
    level = path.full_end[path.axial]
    _set_feed(path, block, path.current, centre=centre, turns=turns, rise=level - path.level)
    gamma = _direction(path.end, centre) if inside else _direction(centre, path.end)
    target = _beside(path.end, path.radius, gamma)
    half = _distance(path.current, target) / 2.0
    base = _direction(target, centre)
    spread = math.cos(_direction(target, path.current) - base)
    if abs(spread) < 1e-4:
        raise ProgramError("tool radius is not less than the radius of the entry arc")
    centre = _beside(target, half / spread, base)
    error = abs(_distance(centre, target) - _distance(centre, path.current))
    if error > path.controller.tolerance.absolute(path.unit_mm):
        raise ProgramError("cutter compensation finds no entry arc")
    if path.controller.orientation not in (0, 9):
        path.add_line(Call.FEED, path.current, (0.0, 0.0), level=path.level)
        path.queue.start = path.current
    angle = arc_angle(path.current, target, centre, turns)
    path.add_arc(target, centre, turns, level=level, angle=angle)
    path.finish(target)


def _following_arc(path: _Path, block: Values) -> None:
    """An arc after another compensated move."""
    start = path.programmed
    centre, turns = arc_centre(path.controller, block, start, path.end)
    level = path.full_end[path.axial]
    programmed_level = path.controller.programmed[path.axial]
    _set_feed(path, block, start, centre=centre, turns=turns, rise=level - programmed_level)
    radius, inside = _distance(centre, path.end), path.inside(turns)
    if inside and radius <= path.radius:
        raise ProgramError(f"tool radius {path.radius:g} is not less than arc radius {radius:g}")
    theta = _direction(start, path.current) - path.side * _QUARTER
    delta = _direction(start, centre)
    alpha = delta + (-_QUARTER if turns > 0 else _QUARTER)
    beta = (theta - alpha) * path.side
    if beta > 1.5 * _HALF:
        beta -= 2.0 * _HALF
    elif beta < -_QUARTER:
        beta += 2.0 * _HALF
    gamma = _direction(path.end, centre) if inside else _direction(centre, path.end)
    target = _beside(path.end, path.radius, gamma)
    if beta < -_TANGENT or beta > _HALF + _TANGENT or (
        abs(beta - _HALF) < _TANGENT and not inside
    ):
        before = path.queue.first
        if before is not None and before.turns:
            path.release_to(_arc_after_arc(path, before, centre, turns=turns, radius=radius))
        else:
            path.release_to(_arc_after_line(path, centre, turns, radius=radius, beta=beta,
                                            theta=theta))  # fmt: skip
    elif beta > _TANGENT:
        middle = _beside(start, path.radius, delta if inside else delta + _HALF)
        path.queue.release()
        path.add_arc(middle, start, -path.side, level=path.level)
        path.queue.release()
        path.queue.start = middle
    else:
        path.release()
    angle = arc_angle(start, path.end, centre, turns)
    path.add_arc(target, centre, turns, level=level, angle=angle)
    path.finish(target)


def _arc_after_line(
    path: _Path, centre: Point, turns: int, *, radius: float, beta: float, theta: float
) -> Point:
    """Concave corner of a line and an arc: where the offset arc cuts the offset line."""
    inside = path.inside(turns)
    across = radius * math.sin(beta - _QUARTER) + (path.radius if inside else -path.radius)
    reach = radius - path.radius if inside else radius + path.radius
    ratio = across / reach if reach else math.inf
    if abs(ratio) > 1.0:
        raise ProgramError("Arc move in concave corner cannot be reached by the tool without "
                           "gouging", hint="use a smaller tool")
    swing = math.asin(ratio) if turns > 0 else -math.asin(ratio)
    angle = theta + swing if inside else theta + _HALF - swing
    return _beside(centre, reach, angle)


def _arc_after_arc(
    path: _Path, before: WaitingMove, centre: Point, *, turns: int, radius: float
) -> Point:
    """Concave corner of two arcs: where the offset arcs meet (law of cosines)."""
    old_radius = _distance(before.centre, before.end)
    new_radius = radius - path.radius if path.inside(turns) else radius + path.radius
    between = _distance(before.centre, centre)
    if old_radius == 0.0 or between == 0.0:
        raise ProgramError("arc to arc motion is invalid because the arcs have the same centre")
    cosine = (old_radius**2 + between**2 - new_radius**2) / (2.0 * old_radius * between)
    if abs(cosine) > 1.0:
        raise ProgramError("arc to arc motion makes a corner the compensated tool can't fit in "
                           "without gouging", hint="use a smaller tool")
    pullback = math.acos(cosine) if path.inside(before.turns) == (turns > 0) else -math.acos(cosine)
    return _beside(before.centre, old_radius, _direction(before.centre, centre) + pullback)
