"""G73 to G89 as Fanuc and Haas have them (B-64484EN-2, "Canned cycle for drilling")."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from gcode.dialects.fanuc.block import MacroBlock
from gcode.dialects.fanuc.pecking import PECKING, peck_depths
from gcode.errors import ProgramError
from gcode.motion.interpolation import traverse
from gcode.state.block_values import whole
from gcode.state.controller import PLANE_AXES
from gcode.state.record import Call

if TYPE_CHECKING:
    from gcode.dialects.fanuc.blocks import BlockRunner

__all__ = ["CYCLES", "DrillingCycle"]

_NAMES = "xyz"


class DrillingCycle:
    """A cycle in force and its data, which stay until it is cancelled.

    Parameters
    ----------
    code : float
        As 81.0.
    initial : float
        Level to which G98 retracts: where the axis stood when the first cycle began.
    previous : DrillingCycle or None
        Whose data stay.
    """

    def __init__(self, code: float, initial: float, previous: DrillingCycle | None) -> None:
        self.code, self.initial = code, initial
        self.r: float | None = previous.r if previous else None  #: levels, absolute
        self.bottom: float | None = previous.bottom if previous else None
        self.dwell_s = previous.dwell_s if previous else 0.0
        self.words: dict[str, float] = dict(previous.words) if previous else {}

    def __repr__(self) -> str:
        return f"{self.code} {self.r} {self.bottom} {self.dwell_s} {sorted(self.words.items())}"

    def obey(self, runner: BlockRunner, block: MacroBlock) -> bool:
        """Take the data of a block and do the holes that it asks for."""
        controller = runner.controller
        axial = PLANE_AXES[controller.plane][2]
        controller.motion = f"G{self.code:g}"
        repeats = self._take(runner, block, axial)
        if not block.words.keys() & set(_NAMES) and not self._new_levels:
            if block.words or block.g:
                runner.execute(block.text())
            return False
        controller.require_no_compensation(f"use G{self.code:g}")
        if self.bottom is None:
            raise ProgramError(f"G{self.code:g} without {_NAMES[axial].upper()} word")
        if self.r is None:
            self.r = self.initial
        if controller.feed == 0.0:
            raise ProgramError(f"G{self.code:g} with feed zero", hint="give a feed first")
        block.words.pop(_NAMES[axial], None)
        for _ in range(repeats):
            self.hole_at(runner, runner.target(block))
        controller.motion = f"G{self.code:g}"
        return repeats > 0

    def hole_at(self, runner: BlockRunner, end: list[float]) -> None:
        """One hole at a programmed place, with the data in force."""
        first, second, axial = PLANE_AXES[runner.controller.plane]
        runner.place_for_hole(end)
        _Hole(runner, self, end, (first, second, axial)).drill()
        runner.controller.motion = f"G{self.code:g}"

    def _take(self, runner: BlockRunner, block: MacroBlock, axial: int) -> int:
        """R, depth, P, Q, I J K from the block; gives the number of repetitions."""
        absolute, words = runner.controller.absolute, block.words
        name = _NAMES[axial]
        self._new_levels = "r" in words or name in words
        if "r" in words:
            r = words.pop("r")
            self.r = r if absolute else self.initial + r
        if name in words:
            above = self.initial if self.r is None else self.r
            self.bottom = words[name] if absolute else above + words[name]
        if "p" in words:
            pointed = "p" not in block.pointless and runner.settings.pointed_p_is_seconds
            self.dwell_s = words.pop("p") * (1.0 if pointed else runner.settings.dwell_p_s)
        self._take_pecks(block, haas=runner.settings.haas_cycles)
        if runner.settings.haas_cycles and self.code in (74.0, 84.0) and "j" in self.words:
            runner.controller.note("J", "the tap comes out J times as fast; timed with F alone")
        block.pop("e")
        repeats = [words.pop(letter) for letter in "kl" if letter in words]
        count = whole(repeats[0], "K or L word") if repeats else 1
        if count < 0:
            raise ProgramError(f"G{self.code:g} repeated {count} times")
        return count

    def _take_pecks(self, block: MacroBlock, *, haas: bool) -> None:
        """Q, I, J, D; K of Haas is the least peck, or how deep before the chips are cleared."""
        given = block.pop("qijdk" if haas else "qijd")
        if "k" in given and self.code not in PECKING:
            raise ProgramError(f"K word in G{self.code:g}", accepted="L with the number of holes")
        if "k" in given and {"q", "i"} <= given.keys():
            raise ProgramError(f"Q beside I J K in G{self.code:g}", accepted="Q, or I J K")
        if haas and given.keys() & set("qk"):  # one way to peck takes the place of another
            self.words = {name: value for name, value in self.words.items() if name not in "qijk"}
        self.words |= given


class _Hole:
    """One hole: levels of the programmed axis, transformed by the runner where they are gone to."""

    def __init__(
        self, runner: BlockRunner, cycle: DrillingCycle, place: list[float],
        axes: tuple[int, int, int],
    ) -> None:  # fmt: skip
        self.runner, self.cycle, self.place, self.axes = runner, cycle, place, axes
        controller = runner.controller
        self.r, self.bottom = cycle.r, cycle.bottom
        self.clear = cycle.initial if controller.retract_to_initial else self.r

    def drill(self) -> None:
        """Above the hole, to R, the cycle, and out."""
        if self.cycle.code != 87.0:  # whose R lies below the hole
            self.rapid(self.r)
        _CYCLES[self.cycle.code](self)
        self.rapid(self.clear)
        self.runner.stand_at(self.point(self.clear))

    def point(self, level: float, aside: tuple[float, float] = (0.0, 0.0)) -> list[float]:
        """Programmed point of the hole's axis at a level."""
        first, second, axial = self.axes
        point = list(self.place)
        point[first] += aside[0]
        point[second] += aside[1]
        point[axial] = level
        return point

    def go(self, call: Call, level: float, aside: tuple[float, float] = (0.0, 0.0)) -> None:
        """Move to a level."""
        controller = self.runner.controller
        end = list(controller.position)
        end[:3] = self.runner.transform.point(self.point(level, aside))
        traverse(controller, end, call)

    def rapid(self, level: float, aside: tuple[float, float] = (0.0, 0.0)) -> None:
        """At rapid."""
        self.go(Call.TRAVERSE, level, aside)

    def feed(self, level: float) -> None:
        """At feed."""
        self.go(Call.FEED, level)

    def dwell(self) -> None:
        """P, where there is one."""
        if self.cycle.dwell_s:
            self.runner.controller.record.dwell(self.cycle.dwell_s)

    def pecks(self) -> list[float]:
        """Levels of the pecks but the last."""
        down = 1.0 if self.bottom > self.r else -1.0
        depths = peck_depths(self.cycle.code, self.cycle.words, abs(self.bottom - self.r))
        return [self.r + down * depth for depth in depths]

    def clearance(self) -> float:
        """Above the last depth, signed towards R."""
        size = self.runner.settings.peck_clearance_mm / self.runner.controller.unit_mm
        return size if self.bottom < self.r else -size

    def shift(self) -> tuple[float, float]:
        """By which G76 and G87 leave the wall: I J, or Q along the first axis."""
        words = self.cycle.words
        if "i" in words or "j" in words:
            return words.get("i", 0.0), words.get("j", 0.0)
        return abs(words.get("q", 0.0)), 0.0


def _g81(hole: _Hole) -> None:
    hole.feed(hole.bottom)
    hole.dwell() if hole.cycle.code == 82.0 else None


def _g73(hole: _Hole) -> None:
    """By pecks; with K beside Q (Haas) out to R when they come to K."""
    q, total = hole.cycle.words.get("q"), hole.cycle.words.get("k", math.inf)
    since = hole.r  #: where the tool was last out of the hole
    for depth in hole.pecks():
        hole.feed(depth)
        if q is not None and abs(depth - since) > total - 1e-9:
            hole.rapid(hole.r)
            since = depth
        hole.rapid(depth + hole.clearance())
    hole.feed(hole.bottom)
    hole.dwell()


def _g83(hole: _Hole) -> None:
    for depth in hole.pecks():
        hole.feed(depth)
        hole.rapid(hole.r)
        hole.rapid(depth + hole.clearance())
    hole.feed(hole.bottom)
    hole.dwell()


def _g84(hole: _Hole) -> None:
    """G74 and G84: down and back at feed with the spindle turned round, by pecks with Q."""
    for depth in hole.pecks():
        hole.feed(depth)
        hole.feed(hole.r)
        hole.feed(depth + hole.clearance())
    hole.feed(hole.bottom)
    hole.dwell()
    hole.feed(hole.r)


def _g85(hole: _Hole) -> None:
    """G85 and G89: in and out at feed."""
    hole.feed(hole.bottom)
    hole.dwell() if hole.cycle.code == 89.0 else None
    hole.feed(hole.r)


def _g86(hole: _Hole) -> None:
    """G86, and G88 whose retraction by hand is taken for granted."""
    hole.feed(hole.bottom)
    hole.dwell() if hole.cycle.code == 88.0 else None
    if hole.cycle.code == 88.0:
        hole.runner.controller.note("G88", "retraction by hand")


def _g76(hole: _Hole) -> None:
    """Bore, leave the wall by the shift, out."""
    hole.feed(hole.bottom)
    hole.dwell()
    aside = hole.shift()
    hole.rapid(hole.bottom, aside)
    hole.rapid(hole.clear, aside)


def _g87(hole: _Hole) -> None:
    """Back boring: down beside the axis to R, in, up at feed to Z, aside again and out."""
    aside = hole.shift()
    if hole.runner.controller.retract_to_initial is False:
        raise ProgramError("G87 in G99 has no retraction", accepted="G98")
    hole.rapid(hole.cycle.initial, aside)
    hole.rapid(hole.r, aside)
    hole.rapid(hole.r)
    hole.feed(hole.bottom)
    hole.dwell()
    hole.rapid(hole.bottom, aside)
    hole.rapid(hole.cycle.initial, aside)


_CYCLES: dict[float, Callable[[_Hole], None]] = {
    73.0: _g73, 74.0: _g84, 76.0: _g76, 81.0: _g81, 82.0: _g81, 83.0: _g83, 84.0: _g84,
    85.0: _g85, 86.0: _g86, 87.0: _g87, 88.0: _g86, 89.0: _g85,
}  # fmt: skip
CYCLES = frozenset(_CYCLES)
