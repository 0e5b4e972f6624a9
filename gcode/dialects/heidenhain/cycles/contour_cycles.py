"""Klartext cycles 14 and 20 to 25: pockets whose walls are contours in subprograms.

Source: HEIDENHAIN TNC 640 User's Manual Cycle Programming, "SL cycles": 14 names the labels,
20 has the data of all of them, 21 drills where 22 begins, 22 roughs, 23 finishes the floor, 24 the
sides; 25 mills along one contour. A contour is a pocket where the tool's radius lies inside it,
otherwise an island. The way through the material is the control's own; rings are taken here.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.cycles.contours import read_contour
from gcode.dialects.heidenhain.cycles.parameter import cycle_parameter
from gcode.dialects.heidenhain.tool_call import tool_of_spindle
from gcode.errors import ProgramError
from gcode.geometry.arcs import Point
from gcode.geometry.regions import CHORD_MM, Region, polyline
from gcode.language.area_milling import check_rounds
from gcode.language.contours import Contour
from gcode.language.translate import number, xy_words

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["CONTOUR_CYCLES", "ContourCycles"]

CONTOUR_CYCLES = frozenset((21, 22, 23, 24, 25))
_MOST = 10_000  #: rings or levels
#: by which rings that touch no wall may leave their way
_INNER_MM = 0.01


class ContourCycles:
    """Labels of cycle 14, data of cycles 20 and 270."""

    def __init__(self) -> None:
        self.labels: list[str] = []
        self.data: dict[str, float] = {}
        self.train: dict[str, float] = {}  #: of cycle 270

    def name_labels(self, text: str) -> None:
        """``14.1 CONTOUR LABEL 1 /2 /3``."""
        if text.startswith("14.0"):
            return
        self.labels = re.findall(r"\d+", re.sub(r"^14\.\d+", "", text))
        if not self.labels:
            raise ProgramError(f"cannot read 'CYCL DEF {text}'", accepted="CONTOUR LABEL 1 /2")

    def run(self, reader: KlartextReader, cycle: int, own: Mapping[str, float]) -> None:
        """Do a cycle; it stands where its contours do."""
        if not self.labels:
            raise ProgramError(f"cycle {cycle} without contours", accepted="CYCL DEF 14 before it")
        if cycle != 25 and not self.data:
            raise ProgramError(f"cycle {cycle} without CYCL DEF 20 CONTOUR DATA before it")
        contours = [read_contour(reader, label) for label in self.labels]
        if cycle == 25 and "391" in self.train:
            side = {0: 0, 1: 1, 2: -1}.get(int(self.train["391"]))
            if side is None:
                raise ProgramError(f"Q391={self.train['391']:g} of cycle 270", accepted="0 to 2")
            contours = [replace(contour, side=side) for contour in contours]
        reader.controller.note(
            f"CYCL DEF {cycle}",
            "the way through the material is the control's own; rings are taken here, walls and "
            "floor are those of the contours",
        )
        reader.execute(*_Milling(reader, cycle, {**self.data, **own}, contours).blocks())


class _Milling:
    """One cycle with its data."""

    def __init__(
        self, reader: KlartextReader, cycle: int, data: Mapping[str, float],
        contours: list[Contour],
    ) -> None:  # fmt: skip
        self.reader, self.cycle, self.data, self.contours = reader, cycle, data, contours
        self.unit_mm = reader.controller.unit_mm
        self.chord = CHORD_MM / self.unit_mm
        self.tool_radius = tool_of_spindle(reader).offset_diameter_mm / 2.0 / self.unit_mm
        self.surface, self.clear = self.q(5, 0.0), self.q(7)
        self.near = min(self.surface + abs(self.q(6, 0.0)), self.clear)
        self.floor = self.surface + self.q(1)
        if not self.floor < self.surface <= self.clear:
            raise ProgramError(
                f"Q1={self.q(1):g}, Q5={self.surface:g}, Q7={self.clear:g}",
                accepted="a negative depth Q1, and Q7 above the surface Q5",
            )
        if self.tool_radius <= 0.0 and cycle != 21:
            raise ProgramError("a milling cycle needs a tool with a diameter")

    def q(self, number: int, default: float | None = None) -> float:
        """A parameter."""
        return cycle_parameter(self.data, self.cycle, number, default)

    def feed(self, name: int) -> float:
        """A feed; that of TOOL CALL where it is not said."""
        feed = self.data.get(str(name), self.reader.motion.tool_feed)
        if not feed:
            raise ProgramError(f"Q{name} of cycle {self.cycle} is missing")
        return feed

    def blocks(self) -> Iterator[str]:
        """The cycle as blocks of RS274/NGC."""
        yield f"g0z{number(max(self.clear, self.reader.here()[2]))}"
        if self.cycle == 25:
            yield from self._along()
            return
        floor_allowance = self.q(4, 0.0)
        if self.cycle == 21:
            yield from self._pilot_holes(self.floor + floor_allowance)
        elif self.cycle == 22:
            levels = self._levels(self.floor + floor_allowance)
            check_rounds(len(self._rings), len(levels))
            for level in levels:
                yield from self._area(level, self.feed(12))
        elif self.cycle == 23:
            yield from self._area(self.floor, self.feed(12))
        else:
            wall = self._region().shrunk(self.tool_radius + self.q(14, 0.0), self.chord).rings()
            for level in self._levels(self.floor):
                for ring in wall:
                    yield from self._ring(ring, level, self.feed(12))

    def _region(self) -> Region:
        """Pockets without islands."""
        pockets, islands = (
            [polyline(c.start, c.way, self.chord) for c in self.contours if c.is_island == kind]
            for kind in (False, True)
        )
        if not pockets:
            raise ProgramError("contours without a pocket: all have the radius outside",
                               accepted="RL or RR inside the first contour")  # fmt: skip
        return Region(pockets).without(Region(islands))

    def _levels(self, floor: float) -> list[float]:
        """Levels of the infeeds Q10."""
        step, depth = abs(self.q(10, 0.0)), self.surface - floor
        count = math.ceil(depth / step - 1e-9) if step > 0.0 else 1
        if count > _MOST:
            raise ProgramError(f"infeeds Q10={step:g} make {count} levels")
        return [max(self.surface - step * (k + 1), floor) if step else floor for k in range(count)]

    @cached_property
    def _rings(self) -> list[list[Point]]:
        """Ways of the tool's axis over the whole area, from the inside out."""
        step = min(max(self.q(2, 1.0), 0.1), 1.0) * self.tool_radius
        region, found = self._region(), []
        for k in range(_MOST):
            shrunk = region.shrunk(self.tool_radius + self.q(3, 0.0) + k * step, self.chord)
            rings = shrunk.rings(_INNER_MM / self.unit_mm) if k else shrunk.rings()
            if not rings:
                break
            found.append(rings)
        if not found:
            raise ProgramError(
                f"a tool of radius {self.tool_radius:g} is too large for the contour"
            )
        return [ring for rings in reversed(found) for ring in rings]

    def _area(self, level: float, feed: float) -> Iterator[str]:
        for ring in self._rings:
            yield from self._ring(ring, level, feed)

    def _ring(self, ring: list[Point], level: float, feed: float) -> Iterator[str]:
        if self.q(9, 1.0) < 0.0:
            ring = ring[::-1]
        start = xy_words(ring[0][0], ring[0][1])
        yield f"g0{start}"
        yield f"g0z{number(self.near)}"
        yield f"g1z{number(level)}f{number(self.feed(11))}"
        for k, (x, y) in enumerate((*ring[1:], ring[0])):
            yield f"g1{xy_words(x, y)}" + (f"f{number(feed)}" if k == 0 else "")
        yield f"g0z{number(self.clear)}"

    def _pilot_holes(self, bottom: float) -> Iterator[str]:
        """Where the rings of the coarse tool Q13 begin."""
        tool = self.reader.controller.offsets.get(int(self.q(13, 0.0)))
        if tool is not None:
            self.tool_radius = tool.offset_diameter_mm / 2.0 / self.unit_mm
        if self.tool_radius <= 0.0:
            raise ProgramError("cycle 21 needs Q13, the number of the tool that roughs")
        for x, y in dict.fromkeys(ring[0] for ring in self._rings):
            yield f"g0{xy_words(x, y)}"
            yield f"g0z{number(self.near)}"
            for level in self._levels(bottom):
                yield f"g1z{number(level)}f{number(self.feed(11))}"
                yield f"g0z{number(self.near)}"
            yield f"g0z{number(self.clear)}"

    def _along(self) -> Iterator[str]:
        """Cycle 25: beside an open or closed contour, in the sense in which it is written."""
        if len(self.contours) != 1:
            raise ProgramError("cycle 25 with several contours", accepted="one label in cycle 14")
        contour = self.contours[0]
        begin, end = contour.ends_beside(self.tool_radius)
        if self.q(3, 0.0):
            raise ProgramError("cycle 25 with an allowance Q3", accepted="Q3=0, or DR of TOOL CALL")
        tool = self.reader.controller.tool
        for level in self._levels(self.floor):
            yield f"g0{xy_words(begin[0], begin[1])}"
            yield f"g1z{number(level)}f{number(self.feed(11))}"
            if contour.side:
                yield f"g{41 if contour.side > 0 else 42}d{tool}"
            start = xy_words(contour.start[0], contour.start[1])
            yield f"g1{start}f{number(self.feed(12))}"
            yield from contour.blocks()
            yield "g40"
            yield f"g1{xy_words(end[0], end[1])}"  # up from beside the contour
            yield f"g0z{number(self.clear)}"
