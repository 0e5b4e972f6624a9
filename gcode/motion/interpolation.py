"""G0, G1, G2, G3 and probing: where a block ends and what it makes the machine do.

Source: NISTIR 6556 (RS274/NGC), G0 to G3 and G38.2; LinuxCNC, G-Codes.
"""

from __future__ import annotations

import math

from gcode.errors import ProgramError
from gcode.geometry import arcs
from gcode.motion import cutter_compensation
from gcode.motion.arc_words import arc_centre, check_arc_words
from gcode.motion.feed import check_feed, set_inverse_time_feed
from gcode.state.block_values import Values
from gcode.state.codes import AXES
from gcode.state.controller import PLANE_AXES, XY, YZ, Controller, rotate
from gcode.state.record import Call

__all__ = ["arc", "block_end", "probe", "straight", "traverse"]


def block_end(controller: Controller, block: Values) -> list[float]:
    """Position X Y Z A B C at which the block ends, program units."""
    if block.g.get("nonmodal") == "G53":
        return _machine_end(controller, block)
    start = _axis_start(controller)
    words = block.words
    if controller.absolute:
        end = [words.get(letter, start[axis]) for axis, letter in enumerate(AXES)]
    else:
        end = [start[axis] + words.get(letter, 0.0) for axis, letter in enumerate(AXES)]
    if "@" in words or "^" in words:
        _polar(controller, words, end)
    return end


def _axis_start(controller: Controller) -> list[float]:
    """Where axes without a word stay: the programmed point while compensation is on."""
    start = list(controller.position)
    if controller.side and not controller.entering:
        start[0] = controller.programmed[0]
        start[1 if controller.plane == XY else 2] = controller.programmed[
            1 if controller.plane == XY else 2
        ]
        if controller.plane == YZ:
            start[1:3] = controller.position[1:3]
    return start


def _machine_end(controller: Controller, block: Values) -> list[float]:
    """G53: words are machine coordinates of the controlled point."""
    words = block.words
    if "@" in words or "^" in words:
        raise ProgramError("polar coordinates with G53", accepted="X Y Z")
    c = controller
    end = [p + g for p, g in zip(c.turn.apply(c.position), c.g92, strict=True)]
    rotate(end, c.rotation_deg)
    for axis in (0, 1):
        if AXES[axis] in words:
            end[axis] = words[AXES[axis]] - c.origin[axis] - c.tool_offset[axis]
    rotate(end, -c.rotation_deg)
    end = c.turn.undo([e - g for e, g in zip(end, c.g92, strict=True)])
    for axis in range(2, 6):
        end[axis] = c.position[axis]
        if AXES[axis] in words:
            tool = c.tool_offset[axis] if axis == 2 else 0.0
            end[axis] = words[AXES[axis]] - c.origin[axis] - c.g92[axis] - tool
    return end


def _polar(controller: Controller, words: dict[str, float], end: list[float]) -> None:
    """Replace X and Y of `end` by the polar words @ (radius) and ^ (angle in degrees)."""
    x, y = end[0], end[1]
    if controller.absolute:
        if "@" in words and "^" not in words and x == 0.0 and y == 0.0:
            raise ProgramError("polar radius @ at the origin needs an angle ^")
        radius = words.get("@", math.hypot(y, x))
        angle = math.radians(words["^"]) if "^" in words else math.atan2(y, x)
    else:
        if x == 0.0 and y == 0.0:
            raise ProgramError("incremental polar motion is indeterminate at the origin")
        radius = math.hypot(y, x) + words.get("@", 0.0)
        angle = math.atan2(y, x) + math.radians(words.get("^", 0.0))
    end[0], end[1] = radius * math.cos(angle), radius * math.sin(angle)


def _straight_length(start: list[float], end: list[float]) -> float:
    linear = [b - a for a, b in zip(start[:3], end[:3], strict=True)]
    angular = [b - a for a, b in zip(start[3:], end[3:], strict=True)]
    moved = linear if any(abs(d) > 1e-7 for d in linear) else angular
    return math.sqrt(sum(d * d for d in moved))


def straight(controller: Controller, block: Values, motion: str) -> None:
    """G0 and G1, with cutter compensation where it is on."""
    controller.straight_only = False
    if motion == "G1":
        check_feed(controller, block, "G1")
    controller.motion = motion
    end = block_end(controller, block)
    compensated = controller.side and controller.radius > 0.0
    if motion == "G1" and controller.feed_mode == "inverse":
        start = list(controller.position)
        if compensated and not controller.entering:
            start[:3] = controller.programmed
        set_inverse_time_feed(controller, block, _straight_length(start, end))
    if compensated:
        if block.g.get("nonmodal") == "G53":
            raise ProgramError("cannot use G53 with cutter compensation on")
        cutter_compensation.straight(controller, motion, end)
        return
    if controller.leaving is not None:
        cutter_compensation.leave(controller, motion, end)
        return
    traverse(controller, end, Call.FEED if motion == "G1" else Call.TRAVERSE)


def traverse(controller: Controller, end: list[float], call: Call = Call.TRAVERSE) -> None:
    """Go straight to `end` without compensation."""
    cutter_compensation.flush(controller) if controller.leaving is not None else None
    controller.record.straight(call, end)
    controller.position = end


def arc(controller: Controller, block: Values, motion: str) -> None:
    """G2 and G3 in any plane, helices and several turns included."""
    check_arc_words(controller, block)
    end = block_end(controller, block)
    controller.motion = motion
    if controller.side and controller.radius > 0.0:
        cutter_compensation.arc(controller, block, end)
        return
    cutter_compensation.flush(controller) if controller.leaving is not None else None
    first, second, axial = PLANE_AXES[controller.plane]
    start = controller.position
    start2, end2 = (start[first], start[second]), (end[first], end[second])
    centre, turns = arc_centre(controller, block, start2, end2)
    if controller.feed_mode == "inverse":
        rise = end[axial] - start[axial]
        length = arcs.arc_length(start2, end2, centre, turns=turns, rise=rise)
        set_inverse_time_feed(controller, block, length)
    numbers = (*end2, *centre, turns, end[axial])
    controller.record.arc(controller.plane, numbers, position=end)
    controller.position = end


def probe(controller: Controller, block: Values, motion: str) -> None:
    """G38.n: a straight probing move that runs its full length."""
    controller.require_no_compensation("probe")
    if controller.feed == 0.0:
        raise ProgramError("probing with feed zero", hint="give a feed first")
    if controller.feed_mode == "revolution":
        raise ProgramError("probing with feed per revolution")
    end = block_end(controller, block)
    if motion in ("G38.2", "G38.4") and end == controller.position:
        raise ProgramError("probe ends where it starts")
    controller.motion = motion
    traverse(controller, end, Call.PROBE)
    controller.refresh = True
    reached = controller.from_machine(controller.machine_position())
    controller.parameters.set_vector(5061, reached)
    controller.parameters.numbered[5070] = 0.0
