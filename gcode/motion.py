"""G0, G1, G2, G3 and probing: where a block ends and what it makes the machine do."""

from __future__ import annotations

import math

from gcode import arcs, cutter_compensation
from gcode.block_values import Values
from gcode.codes import AXES
from gcode.errors import ProgramError
from gcode.record import Call
from gcode.state import PLANE_AXES, XY, YZ, Controller, rotate

__all__ = ["arc", "block_end", "check_feed", "probe", "set_inverse_time_feed", "straight",
           "traverse"]  # fmt: skip


def block_end(controller: Controller, block: Values) -> list[float]:
    """Position X Y Z A B C at which the block ends, program units."""
    if block.g.get("nonmodal") == 530:
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
    end = [p + g for p, g in zip(c.position, c.g92, strict=True)]
    rotate(end, c.rotation_deg)
    for axis in (0, 1):
        if AXES[axis] in words:
            end[axis] = words[AXES[axis]] - c.origin[axis] - c.tool_offset[axis]
    rotate(end, -c.rotation_deg)
    end = [e - g for e, g in zip(end, c.g92, strict=True)]
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


def check_feed(controller: Controller, block: Values, name: str) -> None:
    """Raise ProgramError where a feed move has no feed."""
    if controller.feed_mode == "inverse":
        if "f" not in block.words:
            raise ProgramError(f"{name} without F in inverse time mode (G93)",
                               hint="every move needs its own F")
        return
    if controller.feed == 0.0:
        raise ProgramError(f"{name} with feed zero", hint="give a feed first, for example F500")
    if controller.feed_mode == "revolution" and controller.speed == 0.0:
        raise ProgramError(f"{name} with feed per revolution and spindle speed zero",
                           hint="give a speed with S")


def set_inverse_time_feed(controller: Controller, block: Values, length: float) -> None:
    """G93: turn F (moves a minute) into a feed for a move of this length."""
    if controller.feed_mode != "inverse":
        return
    rate = 0.1 if length == 0.0 else length * block.words["f"]
    controller.queue.say(lambda: controller.record.set_feed(rate))
    controller.feed = rate


def _straight_length(start: list[float], end: list[float]) -> float:
    linear = [b - a for a, b in zip(start[:3], end[:3], strict=True)]
    angular = [b - a for a, b in zip(start[3:], end[3:], strict=True)]
    moved = linear if any(abs(d) > 1e-7 for d in linear) else angular
    return math.sqrt(sum(d * d for d in moved))


def straight(controller: Controller, block: Values, motion: int) -> None:
    """G0 and G1, with cutter compensation where it is on."""
    controller.straight_only = False
    if motion == 10:
        check_feed(controller, block, "G1")
    controller.motion = motion
    end = block_end(controller, block)
    compensated = controller.side and controller.radius > 0.0
    if motion == 10 and controller.feed_mode == "inverse":
        start = list(controller.position)
        if compensated and not controller.entering:
            start[:3] = controller.programmed
        set_inverse_time_feed(controller, block, _straight_length(start, end))
    if compensated:
        if block.g.get("nonmodal") == 530:
            raise ProgramError("cannot use G53 with cutter compensation on")
        cutter_compensation.straight(controller, motion, end)
        return
    traverse(controller, end, Call.FEED if motion == 10 else Call.TRAVERSE)


def traverse(controller: Controller, end: list[float], call: Call = Call.TRAVERSE) -> None:
    """Go straight to `end` without compensation."""
    controller.record.straight(call, end)
    controller.position = end


def arc_offsets(controller: Controller, words: dict[str, float]) -> tuple[float, float]:
    """I J K of the plane as (first, second); missing ones are zero unless G90.1 is on."""
    first, second, axial = PLANE_AXES[controller.plane]
    letters = "ijk"
    if letters[axial] in words:
        raise ProgramError(f"{letters[axial].upper()} word in an arc of plane "
                           f"{'XYZ'[first]}{'XYZ'[second]}",
                           accepted=f"{letters[first].upper()} {letters[second].upper()}")
    for index in (first, second):
        if letters[index] not in words and controller.arc_absolute:
            raise ProgramError(f"{letters[index].upper()} word missing in arc with absolute centre")
    return words.get(letters[first], 0.0), words.get(letters[second], 0.0)


def check_arc_words(controller: Controller, block: Values) -> None:
    """Raise ProgramError where the words of an arc contradict each other."""
    words = block.words
    has_ijk = any(letter in words for letter in "ijk")
    if controller.straight_only:
        raise ProgramError("the move after the end of cutter compensation must be straight",
                           hint="insert G0 or G1 before the arc")
    if "r" not in words and not has_ijk:
        raise ProgramError("arc without R, I, J or K")
    if "r" in words and has_ijk:
        raise ProgramError("arc with R and with I, J or K", accepted="one of the two")
    check_feed(controller, block, "arc")
    if has_ijk:
        arc_offsets(controller, words)
        return
    first, second, _ = PLANE_AXES[controller.plane]
    polar = controller.plane == XY and ("@" in words or "^" in words)
    if AXES[first] not in words and AXES[second] not in words and not polar:
        raise ProgramError(f"arc with R without {AXES[first].upper()} and {AXES[second].upper()}")


def arc_centre(
    controller: Controller, block: Values, start: arcs.Point, end: arcs.Point
) -> tuple[arcs.Point, int]:
    """Centre in the plane's coordinates, and turns (negative clockwise)."""
    words = block.words
    clockwise = block.motion == 20
    turns = math.floor(words.get("p", 1.0) + 0.5)
    if "r" in words:
        centre = arcs.centre_from_radius(start, end, words["r"], clockwise=clockwise,
                                         unit_mm=controller.unit_mm)  # fmt: skip
    else:
        centre = arcs.centre_from_offsets(
            start, end, arc_offsets(controller, words), absolute=controller.arc_absolute,
            tolerance=controller.tolerance, unit_mm=controller.unit_mm,
        )  # fmt: skip
    return centre, -turns if clockwise else turns


def arc(controller: Controller, block: Values, motion: int) -> None:
    """G2 and G3 in any plane, helices and several turns included."""
    check_arc_words(controller, block)
    end = block_end(controller, block)
    controller.motion = motion
    if controller.side and controller.radius > 0.0:
        cutter_compensation.arc(controller, block, end, arc_centre=arc_centre)
        return
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


def probe(controller: Controller, block: Values, motion: int) -> None:
    """G38.n: a straight probing move that runs its full length."""
    controller.require_no_compensation("probe")
    if controller.feed == 0.0:
        raise ProgramError("probing with feed zero", hint="give a feed first")
    if controller.feed_mode == "revolution":
        raise ProgramError("probing with feed per revolution")
    end = block_end(controller, block)
    if motion in (382, 384) and end == controller.position:
        raise ProgramError("probe ends where it starts")
    controller.motion = motion
    traverse(controller, end, Call.PROBE)
    controller.refresh = True
    reached = controller.from_machine(controller.machine_position())
    controller.parameters.set_vector(5061, reached)
    controller.parameters.numbered[5070] = 0.0
