"""``,R`` and ``,C``: a line that is rounded or chamfered towards the next one (B-64484EN 6.1)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gcode.dialects.fanuc.block import MacroBlock
from gcode.errors import ProgramError
from gcode.state.controller import PLANE_AXES

if TYPE_CHECKING:
    from gcode.dialects.fanuc.blocks import BlockRunner

__all__ = ["HeldLine"]

_STRAIGHT_RAD = 1e-9


@dataclass
class HeldLine:
    """A line whose end waits for the next one.

    Attributes
    ----------
    start, end : list of float
        Programmed X Y Z.
    motion : str
        ``G1``; anything else is refused.
    block : MacroBlock
        With ``,R`` or ``,C`` where it is to be rounded.
    """

    start: list[float]
    end: list[float]
    motion: str
    block: MacroBlock
    line: int | None = None

    def __post_init__(self) -> None:
        if self.motion != "G1":
            raise ProgramError(f",R or ,C between {self.motion} and another motion",
                               accepted="two lines G1")

    def round_towards(self, runner: BlockRunner, other: HeldLine) -> None:
        """Go along this line and round the corner towards another."""
        controller = runner.controller
        first, second, _ = PLANE_AXES[controller.plane]
        kind, size = self.block.corner
        size *= runner.increments.of("r", unit_mm=controller.unit_mm) if size == int(size) else 1.0
        corner = self.end
        back, ahead = _unit(corner, self.start, first, second), _unit(corner, other.end, first,
                                                                      second)  # fmt: skip
        cross = back[0] * ahead[1] - back[1] * ahead[0]
        half = math.atan2(abs(cross), back[0] * ahead[0] + back[1] * ahead[1]) / 2.0
        if abs(cross) < _STRAIGHT_RAD:
            runner.straight_to(corner, "G1", self._rest())
            other.start = corner
            return
        cut = size if kind == "c" else size / math.tan(half)
        if cut > min(_length(corner, self.start), _length(corner, other.end)):
            raise ProgramError(f",{kind.upper()}{size:g} does not fit between the two lines")
        begin, end = list(corner), list(corner)
        for axis, (b, a) in zip((first, second), zip(back, ahead, strict=True), strict=True):
            begin[axis] += cut * b
            end[axis] += cut * a
        runner.straight_to(begin, "G1", self._rest())
        if kind == "c":
            runner.straight_to(end, "G1")
        else:
            words = {"xyz"[axis]: end[axis] for axis in (first, second)} | {"r": size}
            code = 3.0 if cross < 0.0 else 2.0
            runner.arc_to(MacroBlock(words, g=[code]), code)
            controller.motion = "G1"
        other.start = end

    def _rest(self) -> MacroBlock:
        words = {k: v for k, v in self.block.words.items() if k not in "xyz"}
        return MacroBlock(words, g=list(self.block.g))


def _unit(start: list[float], end: list[float], first: int, second: int) -> tuple[float, float]:
    """Direction in the plane."""
    out = end[first] - start[first], end[second] - start[second]
    size = math.hypot(*out)
    if size == 0.0:
        raise ProgramError(",R or ,C beside a line of no length")
    return out[0] / size, out[1] / size


def _length(a: list[float], b: list[float]) -> float:
    return math.dist(a, b)
