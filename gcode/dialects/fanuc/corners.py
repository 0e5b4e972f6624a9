"""``,R`` and ``,C``: a line or arc is rounded or chamfered towards the next one (B-64484EN-2)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from gcode.dialects.fanuc.block import MacroBlock
from gcode.errors import ProgramError
from gcode.geometry.arcs import Point, centre_from_offsets, centre_from_radius
from gcode.geometry.corners import Piece, broken_corner
from gcode.state.controller import PLANE_AXES

if TYPE_CHECKING:
    from gcode.dialects.fanuc.blocks import BlockRunner

__all__ = ["HeldPiece"]

_SENSE = {"G1": 0, "G2": -1, "G3": 1}


@dataclass
class HeldPiece:
    """A line or arc whose end waits for the next one.

    Attributes
    ----------
    runner : BlockRunner
    start, end : list of float
        Programmed X Y Z.
    motion : str
        ``G1``, ``G2`` or ``G3``; anything else is refused.
    block : MacroBlock
        With ``,R`` or ``,C`` where it is to be rounded.
    centre : Point or None
        Of an arc, in the plane.
    line : int
        Its own: the corner is known, and the motion made, only at a later one.
    """

    runner: BlockRunner
    start: list[float]
    end: list[float]
    motion: str
    block: MacroBlock
    centre: Point | None = None
    line: int = field(init=False)

    def __post_init__(self) -> None:
        self.line = self.runner.controller.line
        if self.motion not in _SENSE:
            raise ProgramError(
                f",R or ,C between {self.motion} and another motion", accepted="G1, G2 and G3"
            )
        self.axes = PLANE_AXES[self.runner.controller.plane][:2]
        if self.motion != "G1":
            self.centre = self._centre()

    def _centre(self) -> Point:
        words, controller = self.block.words, self.runner.controller
        start, end = self._flat(self.start), self._flat(self.end)
        if "r" in words:
            return centre_from_radius(start, end, words["r"], clockwise=self.motion == "G2",
                                      unit_mm=controller.unit_mm)  # fmt: skip
        offsets = tuple(words.get("ijk"[axis], 0.0) for axis in self.axes)
        return centre_from_offsets(start, end, offsets, absolute=False, unit_mm=controller.unit_mm,
                                   tolerance=controller.tolerance)  # fmt: skip

    def _flat(self, place: list[float]) -> Point:
        return place[self.axes[0]], place[self.axes[1]]

    @property
    def piece(self) -> Piece:
        """The piece in the plane."""
        return Piece(self._flat(self.start), self._flat(self.end), self.centre, _SENSE[self.motion])

    def round_towards(self, other: HeldPiece) -> None:
        """Go along this piece and break the corner towards another, which then starts behind it."""
        kind, size = self.block.corner
        broken = broken_corner(self.piece, other.piece, size, chamfer=kind == "c")
        begin, end = list(self.end), list(self.end)
        if broken is not None:
            for axis, first, second in zip(self.axes, broken.begin, broken.end, strict=True):
                begin[axis], end[axis] = first, second
        with self.runner.controller.told_as(self.line):
            self.go(begin)
            if broken is not None and kind == "c":
                self.runner.straight_to(end, "G1")
            elif broken is not None:
                words = {"xyz"[axis]: end[axis] for axis in self.axes} | {"r": size}
                code = 3.0 if broken.sense > 0 else 2.0
                self.runner.arc_to(MacroBlock(words, g=[code]), code)
        self.runner.controller.motion = other.motion
        other.start = end

    def go(self, end: list[float]) -> None:
        """The motion itself, to `end`; other words of the block with it."""
        if self.centre is None:
            rest = {k: v for k, v in self.block.words.items() if k not in "xyz"}
            self.runner.straight_to(end, self.motion, MacroBlock(rest, g=list(self.block.g)))
            return
        words = {k: v for k, v in self.block.words.items() if k not in "xyzijkr"}
        words |= {"xyz"[k]: end[k] for k in range(3) if k in self.axes or end[k] != self.start[k]}
        words |= {"ijk"[k]: c - self.start[k] for k, c in zip(self.axes, self.centre, strict=True)}
        code = float(self.motion[1:])
        self.runner.arc_to(MacroBlock(words, g=[code]), code)
