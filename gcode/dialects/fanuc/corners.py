"""``,R`` and ``,C``: a line that is rounded or chamfered towards the next one (B-64484EN-2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gcode.dialects.fanuc.block import MacroBlock
from gcode.errors import ProgramError
from gcode.geometry.corners import broken_corner
from gcode.state.controller import PLANE_AXES

if TYPE_CHECKING:
    from gcode.dialects.fanuc.blocks import BlockRunner

__all__ = ["HeldLine"]


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
            raise ProgramError(
                f",R or ,C between {self.motion} and another motion", accepted="two lines G1"
            )

    def round_towards(self, runner: BlockRunner, other: HeldLine) -> None:
        """Go along this line and round the corner towards another."""
        controller = runner.controller
        first, second, _ = PLANE_AXES[controller.plane]
        kind, size = self.block.corner
        size *= runner.increments.of("r", unit_mm=controller.unit_mm) if size == int(size) else 1.0
        corner = self.end
        places = [(p[first], p[second]) for p in (self.start, corner, other.end)]
        broken = broken_corner(*places, size, chamfer=kind == "c")
        if broken is None:
            runner.straight_to(corner, "G1", self._rest())
            other.start = corner
            return
        begin, end = list(corner), list(corner)
        begin[first], begin[second] = broken[0]
        end[first], end[second] = broken[1]
        runner.straight_to(begin, "G1", self._rest())
        if kind == "c":
            runner.straight_to(end, "G1")
        else:
            words = {"xyz"[axis]: end[axis] for axis in (first, second)} | {"r": size}
            code = 3.0 if broken[2] > 0 else 2.0
            runner.arc_to(MacroBlock(words, g=[code]), code)
            controller.motion = "G1"
        other.start = end

    def _rest(self) -> MacroBlock:
        words = {k: v for k, v in self.block.words.items() if k not in "xyz"}
        return MacroBlock(words, g=list(self.block.g))
