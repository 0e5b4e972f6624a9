"""Canned cycles G73, G74, G76, G81-G89: drilling, tapping, boring, threading as plain moves.

Source: NISTIR 6556 (RS274/NGC), canned cycles; LinuxCNC, G-Codes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from gcode.errors import ProgramError
from gcode.motion.interpolation import traverse
from gcode.state.block_values import Values
from gcode.state.codes import AXES, CODES
from gcode.state.controller import PLANE_AXES, XY, YZ, Controller
from gcode.state.record import Call

__all__ = ["run_cycle"]

#: Clearance above the last depth in G73 and G83, mm.
_PECK_CLEARANCE_MM = 0.254


@dataclass
class Hole:
    """One hole: where it is, how deep, and how the tool gets there.

    `first`, `second` are the coordinates in the plane; `r`, `bottom`, `clear` are levels along
    its axis.
    """

    controller: Controller
    first: float
    second: float
    r: float
    bottom: float
    clear: float

    def go(self, call: Call, level: float, *, at: tuple[float, float] | None = None) -> None:
        """Move to a level, above the hole or above another point of the plane."""
        first, second, axial = PLANE_AXES[self.controller.plane]
        end = list(self.controller.position)
        end[first], end[second] = at or (self.first, self.second)
        end[axial] = level
        traverse(self.controller, end, call)

    def rapid(self, level: float) -> None:
        """G0 along the hole's axis."""
        self.go(Call.TRAVERSE, level)

    def feed(self, level: float) -> None:
        """G1 along the hole's axis."""
        self.go(Call.FEED, level)

    def dwell(self, seconds: float) -> None:
        """Stand still."""
        self.controller.record.dwell(seconds)


def run_cycle(controller: Controller, block: Values, motion: str) -> None:
    """Do a canned cycle at every repetition that the block asks for.

    Raises
    ------
    ProgramError
        Missing or contradictory words, or a mode that forbids cycles.
    """
    _check_modes(controller, motion)
    words, memory, repeats = block.words, controller.cycle, int(block.words.get("l", 1.0))
    fresh = controller.motion != motion
    axial = PLANE_AXES[controller.plane][2]
    if "r" not in words and fresh:
        raise ProgramError(f"{motion} without R word", hint="R is the clearance plane")
    if repeats == 0:
        raise ProgramError(f"{motion} with L0", accepted="L1 or more")
    if AXES[axial] not in words and fresh:
        raise ProgramError(f"{motion} without {AXES[axial].upper()} word")
    _remember(controller, block, motion, fresh=fresh)
    if memory.initial is None:
        memory.initial = controller.position[axial]
    drill = _Drill(controller, block, motion)
    for repeat in range(repeats):
        drill.next_hole(first=repeat == 0)
    controller.motion = motion


def _check_modes(controller: Controller, motion: str) -> None:
    if controller.feed == 0.0:
        raise ProgramError(f"{motion} with feed zero", hint="give a feed first")
    if controller.feed_mode == "inverse":
        raise ProgramError(f"{motion} in inverse time mode", accepted="G94")
    controller.require_no_compensation(f"use {motion}")


def _remember(controller: Controller, block: Values, motion: str, *, fresh: bool) -> None:
    """Take R, depth, P, Q, I J K from the block or from the block before."""
    words, memory = block.words, controller.cycle
    for letter in CODES[motion].first:
        if letter not in words and fresh:
            raise ProgramError(f"{motion} without {letter.upper()} word")
    memory.r = words.get("r", memory.r)
    axial = PLANE_AXES[controller.plane][2]
    memory.bottom = words.get(AXES[axial], memory.bottom)
    memory.p = words.get("p", memory.p)
    memory.q = words.get("q", memory.q)
    memory.ijk = tuple(words.get(k, old) for k, old in zip("ijk", memory.ijk, strict=True))
    if motion in ("G73", "G83") and memory.q <= 0.0:
        raise ProgramError(f"{motion} with Q{memory.q:g}", accepted="a positive Q")


class _Drill:
    """The holes of one block."""

    def __init__(self, controller: Controller, block: Values, motion: str) -> None:
        self.controller, self.motion = controller, motion
        self.clearance = block.words.get("d", _PECK_CLEARANCE_MM / controller.unit_mm)
        memory, words = controller.cycle, block.words
        first, second, axial = PLANE_AXES[controller.plane]
        position = controller.position
        old, self.level = memory.initial, position[axial]
        self.point = [position[first], position[second]]
        self.step = (0.0, 0.0)
        self.polar_step = (0.0, 0.0)
        if controller.absolute:
            self.r, self.bottom = memory.r, memory.bottom
            self.point = self._absolute_point(words, first, second)
        else:
            self.r = memory.r + old
            self.bottom = self.r + memory.bottom
            self.step = (words.get(AXES[first], 0.0), words.get(AXES[second], 0.0))
            self.polar_step = (words.get("@", 0.0), math.radians(words.get("^", 0.0)))
        if self.r < self.bottom:
            raise ProgramError(f"{motion}: R plane {self.r:g} is below the bottom {self.bottom:g}")
        if old < self.r:
            self._lift(axial)
            old = self.level = self.r
        self.clear = old if controller.retract_to_initial else self.r

    def _absolute_point(self, words: dict[str, float], first: int, second: int) -> list[float]:
        x, y = self.point
        if "@" in words or "^" in words:
            radius = words.get("@", math.hypot(y, x))
            angle = math.radians(words["^"]) if "^" in words else math.atan2(y, x)
            return [radius * math.cos(angle), radius * math.sin(angle)]
        return [words.get(AXES[first], x), words.get(AXES[second], y)]

    def _lift(self, axial: int) -> None:
        end = list(self.controller.position)
        end[axial] = self.r
        traverse(self.controller, end)

    def next_hole(self, *, first: bool) -> None:
        """Step to the next hole and drill it."""
        x, y = self.point[0] + self.step[0], self.point[1] + self.step[1]
        if any(self.polar_step):
            if x == 0.0 and y == 0.0:
                raise ProgramError("incremental polar motion is indeterminate at the origin")
            radius = math.hypot(y, x) + self.polar_step[0]
            angle = math.atan2(y, x) + self.polar_step[1]
            x, y = radius * math.cos(angle), radius * math.sin(angle)
        self.point = [x, y]
        hole = Hole(self.controller, x, y, self.r, self.bottom, self.clear)
        above = self.level if first and self.level > self.r else self.clear
        hole.rapid(above)
        if above > self.r:
            hole.rapid(self.r)
        _CYCLES[self.motion](hole, self.clearance)


def _g81(hole: Hole, _: float) -> None:
    hole.feed(hole.bottom)
    hole.rapid(hole.clear)


def _g82(hole: Hole, _: float) -> None:
    hole.feed(hole.bottom)
    hole.dwell(hole.controller.cycle.p)
    hole.rapid(hole.clear)


def _g73(hole: Hole, clearance: float) -> None:
    _peck(hole, clearance, full_retract=False)


def _g83(hole: Hole, clearance: float) -> None:
    _peck(hole, clearance, full_retract=True)


def _peck(hole: Hole, clearance: float, *, full_retract: bool) -> None:
    peck = hole.controller.cycle.q
    if (hole.r - hole.bottom) / peck > 1e6:
        raise ProgramError(f"pecks of Q{peck:g} make more than a million steps")
    depth = hole.r - peck
    while depth > hole.bottom:
        hole.feed(depth)
        if full_retract:
            hole.rapid(hole.r)
        hole.rapid(depth + clearance)
        depth -= peck
    hole.feed(hole.bottom)
    hole.rapid(hole.clear)


def _tap(hole: Hole, sense: int, name: str) -> None:
    """Feed down, stand, feed up.

    In G18 and G19 the control permutes the axes once too often: depth and position change
    places. The tool goes there, so this goes there.
    """
    hole.controller.require_spindle(name)
    if hole.controller.spindle != sense:
        raise ProgramError(
            f"{name} with the spindle turning the wrong way", accepted="M3 for G84, M4 for G74"
        )
    _tap_feed(hole, hole.bottom)
    hole.dwell(hole.controller.cycle.p)
    _tap_feed(hole, hole.clear)
    _finish_tap(hole)


def _tap_feed(hole: Hole, level: float) -> None:
    plane, x, y = hole.controller.plane, hole.first, hole.second
    if plane == XY:
        hole.feed(level)
    elif plane == YZ:
        hole.go(Call.FEED, y, at=(level, x))
    else:
        hole.go(Call.FEED, x, at=(y, level))


def _finish_tap(hole: Hole) -> None:
    """Where the program stands after tapping, whatever the last move was."""
    first, second, axial = PLANE_AXES[hole.controller.plane]
    position = hole.controller.position = list(hole.controller.position)
    position[first], position[second], position[axial] = hole.first, hole.second, hole.clear


def _g74(hole: Hole, _: float) -> None:
    _tap(hole, -1, "G74")


def _g84(hole: Hole, _: float) -> None:
    _tap(hole, 1, "G84")


def _g85(hole: Hole, _: float) -> None:
    hole.feed(hole.bottom)
    hole.feed(hole.r)
    hole.rapid(hole.clear)


def _g86(hole: Hole, _: float) -> None:
    hole.controller.require_spindle("G86")
    _g82(hole, _)


def _g87(hole: Hole, _: float) -> None:
    """Back boring: enter beside the hole, bore upwards to K."""
    hole.controller.require_spindle("G87")
    memory = hole.controller.cycle
    first, second, axial = PLANE_AXES[hole.controller.plane]
    aside = (hole.first + memory.ijk[first], hole.second + memory.ijk[second])
    middle = memory.ijk[axial] + (0.0 if hole.controller.absolute else hole.bottom)
    hole.go(Call.TRAVERSE, hole.r, at=aside)
    hole.go(Call.TRAVERSE, hole.bottom, at=aside)
    hole.rapid(hole.bottom)
    hole.feed(middle)
    hole.feed(hole.bottom)
    hole.go(Call.TRAVERSE, hole.bottom, at=aside)
    hole.go(Call.TRAVERSE, hole.clear, at=aside)
    hole.rapid(hole.clear)


def _g88(hole: Hole, _: float) -> None:
    """Stops at the bottom; the operator retracts by hand to the clear level."""
    hole.controller.require_spindle("G88")
    hole.feed(hole.bottom)
    hole.dwell(hole.controller.cycle.p)
    axial = PLANE_AXES[hole.controller.plane][2]
    hole.controller.note("G88", "retraction by hand")
    hole.controller.position[axial] = hole.clear


def _g89(hole: Hole, _: float) -> None:
    hole.feed(hole.bottom)
    hole.dwell(hole.controller.cycle.p)
    hole.feed(hole.clear)


_CYCLES = {"G73": _g73, "G74": _g74, "G81": _g81, "G82": _g82, "G83": _g83, "G84": _g84,
           "G85": _g85, "G86": _g86, "G87": _g87, "G88": _g88, "G89": _g89}  # fmt: skip
