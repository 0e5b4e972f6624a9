"""G40-G42: the path of the tool's centre beside the programmed contour.

The end of each compensated move waits (`compensation_queue`) until the next move shows which
kind of corner it makes: tangent, convex (an arc about the corner) or concave (both moves are
cut back to where the offset curves meet). A concave corner that the tool cannot reach is
refused. Coordinates are those of the plane: first, second, axial.

Source: NISTIR 6556 (RS274/NGC); LinuxCNC, Cutter Compensation.
"""

from __future__ import annotations

import math

from gcode.errors import ProgramError
from gcode.geometry.arcs import Point, arc_angle, arc_length
from gcode.motion.arc_words import arc_centre
from gcode.motion.compensated_path import (
    HALF,
    LEFT,
    QUARTER,
    RIGHT,
    CompensatedPath,
    beside,
    direction,
    distance,
)  # fmt: skip
from gcode.motion.concave_corners import (
    arc_after_arc,
    arc_after_line,
    line_after_arc,
    line_after_line,
)
from gcode.motion.feed import set_inverse_time_feed
from gcode.state.block_values import Values, whole
from gcode.state.controller import PLANE_AXES, XY, XZ, Controller
from gcode.state.record import Call

__all__ = ["arc", "flush", "straight", "switch"]

#: Corners that turn less than this count as tangent, rad.
_TANGENT = 0.05


def switch(controller: Controller, block: Values, code: str) -> None:
    """Obey G40, G41, G42, G41.1, G42.1."""
    if code == "G40":
        _cancel(controller)
        return
    name = code.partition(".")[0]
    if controller.plane not in (XY, XZ):
        raise ProgramError(f"{name} in plane G19", accepted="G17 or G18")
    if controller.side:
        raise ProgramError(f"{name} with cutter compensation already on", hint="G40 first")
    diameter, orientation = _cutter(controller, block, code)
    side = LEFT if name == "G41" else RIGHT
    controller.side = -side if diameter < 0.0 else side
    controller.radius = abs(diameter) / 2.0
    controller.orientation = orientation
    controller.note(name, "cutter compensation on") if controller.radius == 0.0 else None


def _cutter(controller: Controller, block: Values, code: str) -> tuple[float, int]:
    """Diameter in program units and lathe orientation."""
    words, name = block.words, code.partition(".")[0]
    if code != name:
        if "d" not in words:
            raise ProgramError(f"{name}.1 without D word", accepted="D with the diameter")
        if "l" in words and controller.plane != XZ:
            raise ProgramError(f"{name}.1 with L word outside G18")
        return words["d"], int(words.get("l", 0.0))
    number = whole(words["d"], f"D word of {name}") if "d" in words else controller.loaded
    if number < 0:
        raise ProgramError(f"negative D word D{number}")
    entry = controller.find_offset(number, word="D" if "d" in words else f"{name} with tool T")
    if controller.plane != XZ and entry.orientation not in (0, 9):
        raise ProgramError(f"{name} with a lathe tool outside G18")
    return entry.offset_diameter_mm / controller.unit_mm, entry.orientation


def flush(controller: Controller) -> None:
    """Say everything that waits, ending where the compensated path stands."""
    _end_leaving(controller)
    if controller.queue.items:
        first, second, _ = PLANE_AXES[controller.plane]
        here = (controller.position[first], controller.position[second])
        controller.queue.release_to(here, unit_mm=controller.unit_mm)
    controller.queue.release()


def _cancel(controller: Controller) -> None:
    if controller.side and controller.radius > 0.0 and not controller.entering:
        if controller.start_up in ("B", "in front"):
            controller.leaving = controller.side, list(controller.position)
        else:
            flush(controller)
        controller.position[:3] = controller.programmed
        controller.straight_only = True
    controller.side = 0
    controller.entering, controller.starting = True, False


def _end_leaving(controller: Controller) -> None:
    """The last compensated move ends square beside its end, whatever comes."""
    if controller.leaving is None:
        return
    _, compensated = controller.leaving
    controller.leaving = None
    programmed, controller.position = controller.position, compensated
    flush(controller)
    controller.position = programmed


def _refuse_behind(before: float, ahead: float, what: str) -> None:
    """Refuse an approach or a retraction on the far side of the contour's end, "in front"."""
    if math.cos(before - ahead) < -1e-9:
        raise ProgramError(
            f"{what} behind the contour: how the control goes round its end is not read",
            accepted="a place in front of the contour, where KONT and NORM are the same; or NORM",
        )


def leave(controller: Controller, motion: str, end: list[float]) -> None:
    """The straight move behind G40, type B: an outer corner is gone round as in compensation.

    FANUC B-64484EN-2, "Tool movement in offset mode cancel".
    """
    side, compensated = controller.leaving
    programmed = list(controller.position)
    controller.position, controller.side = list(compensated), side
    path = CompensatedPath(controller, end)
    if path.end != path.programmed:
        heading = direction(path.programmed, path.end)
        theta = direction(path.programmed, path.current)
        turn = math.remainder((theta - heading) * path.side - QUARTER, 2.0 * math.pi)
        if controller.start_up == "in front":
            _refuse_behind(theta - path.side * QUARTER, heading, "the tool leaves to a place")
        elif turn > _TANGENT and path.goes_straight(turn):
            _extended_corner(path, theta, heading)
            controller.leaving = None
            controller.queue.release()
            controller.record.straight(Call.FEED if motion == "G1" else Call.TRAVERSE, end)
            controller.position, controller.side = list(end), 0
            return
    controller.position, controller.side = programmed, 0
    flush(controller)
    controller.record.straight(Call.FEED if motion == "G1" else Call.TRAVERSE, end)
    controller.position = list(end)


def straight(controller: Controller, motion: str, end: list[float]) -> None:
    """G0 and G1 with compensation on."""
    path = CompensatedPath(controller, end)
    call = Call.FEED if motion == "G1" else Call.TRAVERSE
    level = end[path.axial]
    if controller.entering and controller.start_up:
        _begin_start_up(path, call, level)
        return
    if controller.entering:
        if distance(path.current, path.end) <= path.radius:
            raise ProgramError(
                "entry move of cutter compensation is not longer than the tool "
                f"radius {path.radius:g}",
                hint="start further away",
            )
        angle = direction(path.current, path.end) + path.side * QUARTER
        target = beside(path.end, path.radius, angle)
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
    target = beside(path.end, path.radius, heading + path.side * QUARTER)
    _end_start_up(path, heading)
    _corner_before_line(path, call, heading)
    path.add_line(call, target, along, level=level)
    path.finish(target)


def _begin_start_up(path: CompensatedPath, call: Call, level: float) -> None:
    """The first line of Fanuc's compensation: its end waits for the line or arc behind it."""
    path.queue.start = path.current
    path.add_line(call, path.end, (0.0, 0.0), level=level)
    path.controller.start_heading = direction(path.current, path.end)
    path.finish(path.end)
    path.controller.starting = True


def _end_start_up(path: CompensatedPath, heading: float) -> None:
    """Type A: the first line ends square beside the start of the next move.

    Type B does so at inner corners; an outer one is gone round as if compensation had been on
    before. FANUC B-64484EN-2, "Tool movement in start-up".
    """
    if not path.controller.starting:
        return
    path.controller.starting = False
    start = path.controller.start_heading
    turn = math.remainder((start - heading) * path.side, 2.0 * math.pi)
    if path.controller.start_up == "in front":
        _refuse_behind(start, heading, "the tool starts")
    if path.controller.start_up == "B" and turn > _TANGENT:
        path.current = beside(path.programmed, path.radius, start + path.side * QUARTER)
        return
    beside_start = beside(path.programmed, path.radius, heading + path.side * QUARTER)
    path.release_to(beside_start)
    path.current = beside_start


def _extended_corner(path: CompensatedPath, theta: float, heading: float) -> Point:
    """Fanuc's outer corner: both moves go on straight, to where they meet or by the tool's radius.

    FANUC B-64484EN-2, parameter 19607#2 CCC = 0. Gives where the next move begins.
    """
    turn = abs(math.remainder(heading + path.side * QUARTER - theta, 2.0 * math.pi))
    reach = path.radius * (math.tan(turn / 2.0) if turn <= QUARTER + 1e-9 else 1.0)
    ahead = theta - path.side * QUARTER
    first = beside(path.current, reach, ahead)
    onset = beside(path.programmed, path.radius, heading + path.side * QUARTER)
    second = beside(onset, -reach, heading)
    before = path.queue.first
    if before is not None and not before.turns:
        path.release_to(first)
    else:
        path.release_to(path.current)
        path.add_line(Call.FEED, first, (0.0, 0.0), level=path.level)
    if distance(first, second) > 1e-9 * path.radius:
        path.add_line(Call.FEED, second, (0.0, 0.0), level=path.level)
    path.queue.release()
    path.queue.start = second
    return onset


def _corner_before_line(path: CompensatedPath, call: Call, heading: float) -> None:
    """Settle the end of the move before a straight one."""
    theta = direction(path.programmed, path.current)
    turn = (theta - heading) * path.side
    if turn < 0.0:
        turn += 2.0 * math.pi
    beta = turn - QUARTER
    before = path.queue.first
    into_arc = before is not None and before.turns * path.side < 0
    if beta < -_TANGENT or beta > HALF + _TANGENT or (beta > HALF - _TANGENT and into_arc):
        if before is not None and before.turns:
            path.release_to(line_after_arc(path, before, heading))
        else:
            path.release_to(line_after_line(path, beta, theta))
    elif beta > _TANGENT and path.goes_straight(beta):
        _extended_corner(path, theta, heading)
    elif beta > _TANGENT:
        path.release_to(path.current)
        middle = beside(path.programmed, path.radius, heading + path.side * QUARTER)
        if call is Call.FEED:
            path.add_arc(middle, path.programmed, -path.side, level=path.level)
        else:
            path.add_line(call, middle, (0.0, 0.0), level=path.level)
        path.queue.release()
        path.queue.start = middle
    else:
        path.release()


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
    path = CompensatedPath(controller, end)
    if controller.entering and controller.start_up:
        raise ProgramError(
            "cutter compensation begins with an arc", accepted="G41 or G42 in a block with G0 or G1"
        )
    if controller.entering:
        _entry_arc(path, block)
    else:
        _following_arc(path, block)


def _set_feed(path: CompensatedPath, block: Values, start: Point, *, centre: Point, turns: int,
              rise: float) -> None:  # fmt: skip
    length = arc_length(start, path.end, centre, turns=turns, rise=rise)
    set_inverse_time_feed(path.controller, block, length)


def _entry_arc(path: CompensatedPath, block: Values) -> None:
    """First compensated move: an arc from the present point tangent to the offset contour."""
    if distance(path.current, path.end) <= path.radius:
        raise ProgramError(
            f"entry arc of cutter compensation is not larger than the tool radius {path.radius:g}"
        )
    centre, turns = arc_centre(path.controller, block, path.current, path.end)
    inside = path.inside(turns)
    size = abs(block.words["r"]) if "r" in block.words else distance(centre, path.current)
    if inside and size <= path.radius:
        raise ProgramError(f"tool radius {path.radius:g} is not less than arc radius {size:g}")
    level = path.full_end[path.axial]
    _set_feed(path, block, path.current, centre=centre, turns=turns, rise=level - path.level)
    gamma = direction(path.end, centre) if inside else direction(centre, path.end)
    target = beside(path.end, path.radius, gamma)
    half = distance(path.current, target) / 2.0
    base = direction(target, centre)
    spread = math.cos(direction(target, path.current) - base)
    if abs(spread) < 1e-4:
        raise ProgramError(f"tool radius {path.radius:g} is not less than that of the entry arc")
    centre = beside(target, half / spread, base)
    error = abs(distance(centre, target) - distance(centre, path.current))
    if error > path.controller.tolerance.absolute(path.unit_mm):
        raise ProgramError(
            f"cutter compensation finds no entry arc: its ends differ by {error:.3g} in radius"
        )
    if path.controller.orientation not in (0, 9):
        path.add_line(Call.FEED, path.current, (0.0, 0.0), level=path.level)
        path.queue.start = path.current
    angle = arc_angle(path.current, target, centre, turns)
    path.add_arc(target, centre, turns, level=level, angle=angle)
    path.finish(target)


def _following_arc(path: CompensatedPath, block: Values) -> None:
    """An arc after another compensated move."""
    start = path.programmed
    centre, turns = arc_centre(path.controller, block, start, path.end)
    level = path.full_end[path.axial]
    programmed_level = path.controller.programmed[path.axial]
    _set_feed(path, block, start, centre=centre, turns=turns, rise=level - programmed_level)
    radius, inside = distance(centre, path.end), path.inside(turns)
    if inside and radius <= path.radius:
        raise ProgramError(f"tool radius {path.radius:g} is not less than arc radius {radius:g}")
    heading = direction(start, centre) + (-QUARTER if turns > 0 else QUARTER)
    _end_start_up(path, heading)
    theta = direction(start, path.current) - path.side * QUARTER
    delta = direction(start, centre)
    alpha = delta + (-QUARTER if turns > 0 else QUARTER)
    beta = (theta - alpha) * path.side
    if beta > 1.5 * HALF:
        beta -= 2.0 * HALF
    elif beta < -QUARTER:
        beta += 2.0 * HALF
    gamma = direction(path.end, centre) if inside else direction(centre, path.end)
    target = beside(path.end, path.radius, gamma)
    if beta < -_TANGENT or beta > HALF + _TANGENT or (abs(beta - HALF) < _TANGENT and not inside):
        before = path.queue.first
        if before is not None and before.turns:
            path.release_to(arc_after_arc(path, before, centre, turns=turns, radius=radius))
        else:
            path.release_to(arc_after_line(path, centre, turns, radius=radius, beta=beta,
                                            theta=theta))  # fmt: skip
    elif beta > _TANGENT and path.goes_straight(beta):
        onset = _extended_corner(path, direction(start, path.current), heading)
        path.add_line(Call.FEED, onset, (0.0, 0.0), level=path.level)
        path.queue.release()
        path.queue.start = onset
    elif beta > _TANGENT:
        middle = beside(start, path.radius, delta if inside else delta + HALF)
        path.queue.release()
        path.add_arc(middle, start, -path.side, level=path.level)
        path.queue.release()
        path.queue.start = middle
    else:
        path.release()
    angle = arc_angle(start, path.end, centre, turns)
    path.add_arc(target, centre, turns, level=level, angle=angle)
    path.finish(target)
