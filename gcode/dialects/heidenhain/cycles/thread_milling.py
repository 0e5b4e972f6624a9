"""Klartext cycles 262 to 265 and 267: threads by a mill on a helix.

Source: HEIDENHAIN TNC 426/430 User's Manual, "Cycles for drilling, tapping and thread milling":
262 mills a thread into a hole, 263 countersinks it first, 264 drills it first, 265 goes down on one
helix, 267 mills round a stud. In a hole a right-hand thread is milled upwards by climb milling and
downwards by up-cut milling, a left-hand one and one round a stud the other way. Q207 is the feed
of the edge, so the axis is slower in a hole and faster round a stud. How the tool comes to the wall
is the control's own: a semicircle in a hole, a line round a stud.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.cycles.parameter import cycle_parameter
from gcode.dialects.heidenhain.tool_call import tool_of_spindle
from gcode.errors import ProgramError
from gcode.language.translate import number, xy_words

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["THREADS", "mill_thread"]

THREADS = frozenset((262, 263, 264, 265, 267))
_MOST_TURNS = 10_000
#: above the last depth where rapid ends in cycle 264, mm
_ADVANCED_STOP_MM = 0.2


class _Thread:
    """One thread at the present place."""

    def __init__(self, reader: KlartextReader, cycle: int, data: Mapping[str, float]) -> None:
        self.reader, self.cycle, self.data = reader, cycle, data
        self.x, self.y = reader.here()[:2]
        self.surface = self.q(203, 0.0)
        self.clear = self.surface + self.q(200)
        self.out = max(self.clear, self.surface + self.q(204, 0.0))
        self.bottom, self.pitch = self.surface + self.q(201), self.q(239)
        unit = reader.controller.unit_mm
        self.tool_radius = tool_of_spindle(reader).offset_diameter_mm / 2.0 / unit
        self.is_outside = cycle == 267
        wall = self.q(335) / 2.0
        self.radius = wall + (self.tool_radius if self.is_outside else -self.tool_radius)
        self.approach = self.q(253)
        if self.q(201) >= 0.0 or self.pitch == 0.0:
            raise ProgramError(f"thread with Q201={self.q(201):g} and Q239={self.pitch:g}",
                               accepted="a negative depth and a pitch")  # fmt: skip
        if self.radius <= 0.0 or not wall > 0.0:
            raise ProgramError(f"a tool of radius {self.tool_radius:g} does not mill a thread of "
                               f"{self.q(335):g}")  # fmt: skip
        self.feed = self.q(207) * self.radius / wall

    def q(self, number: int, default: float | None = None) -> float:
        """A parameter."""
        return cycle_parameter(self.data, self.cycle, number, default)

    # thread

    def turns(self) -> list[tuple[float, float]]:
        """Where helices begin and end along Z, each with an approach of its own."""
        step = 1 if self.cycle == 265 else int(self.q(355, float(self.cycle in (263, 264))))
        lead = abs(self.pitch)
        depth = -self.q(201)
        if step == 0:
            found = [(self.bottom, self.bottom + lead)]
        elif step == 1:
            found = [(self.bottom, self.bottom + lead * math.ceil(depth / lead - 1e-9))]
        else:
            count = math.ceil(depth / (step * lead) - 1e-9)
            if count > _MOST_TURNS:
                raise ProgramError(f"thread of {count} helices")
            found = [(self.bottom + k * step * lead, self.bottom + (k * step + 1) * lead)
                     for k in range(count)]  # fmt: skip
        return found if self.goes_up else [(high, low) for low, high in reversed(found)]

    @property
    def climbs(self) -> bool:
        """Climb milling: counter-clockwise within a hole."""
        return self.q(351, 1.0) >= 0.0

    @property
    def goes_up(self) -> bool:
        """Cycle 265 always goes down."""
        return self.cycle != 265 and ((self.pitch > 0.0) == self.climbs) != self.is_outside

    @property
    def code(self) -> str:
        """G code of the helix."""
        if self.cycle == 265:
            return "g2" if self.pitch > 0.0 else "g3"
        return "g3" if self.climbs != self.is_outside else "g2"

    def helices(self) -> Iterator[str]:
        """Blocks of the thread, from the middle of the hole, or from beside the stud, and back."""
        code, feed = self.code, f"f{number(self.feed)}"
        wall = xy_words(self.x + self.radius, self.y)
        for first, last in self.turns():
            count = round(abs(last - first) / abs(self.pitch))
            if count > _MOST_TURNS:
                raise ProgramError(f"thread of {count} turns")
            yield f"g1{self.beside}z{number(first)}f{number(self.approach)}"
            yield self._across(wall) + feed
            yield f"{code}{wall}z{number(last)}i{number(-self.radius)}j0p{count}"
            yield self._across(self.beside)

    @property
    def beside(self) -> str:
        """Where the tool touches nothing: the middle of a hole, two radii off a stud's thread."""
        away = self.radius + 2.0 * self.tool_radius if self.is_outside else 0.0
        return xy_words(self.x + away, self.y)

    def _across(self, place: str) -> str:
        if self.is_outside:
            return f"g1{place}"
        return f"{self.code}{place}r{number(self.radius / 2.0)}"

    # before the thread

    def countersink(self) -> Iterator[str]:
        """Q356 with the edge of the chamfer, at the feed of countersinking."""
        depth = self.surface + self.q(356)
        yield f"g1z{number(depth + self.q(200))}f{number(self.approach)}"
        yield f"g1z{number(depth)}f{number(self.q(254))}"

    def drill(self) -> Iterator[str]:
        """Q356 in infeeds Q202, with chip breaks Q257."""
        depth, bottom = self.surface, self.surface + self.q(356)
        step, feed = abs(self.q(202, 0.0)) or -self.q(356), f"f{number(self.q(206))}"
        breaks, back = abs(self.q(257, 0.0)), self.q(256, _ADVANCED_STOP_MM)
        if (depth - bottom) / step > _MOST_TURNS:
            raise ProgramError(f"infeeds Q202={step:g} make more than {_MOST_TURNS} steps")
        yield f"g0z{number(self.clear)}"
        while depth > bottom + 1e-9:
            target = max(depth - step, bottom)
            while breaks > 0.0 and depth - breaks > target + 1e-9:
                depth -= breaks
                yield f"g1z{number(depth)}{feed}"
                yield f"g0z{number(depth + back)}"
            yield f"g1z{number(target)}{feed}"
            yield f"g0z{number(self.clear)}"
            depth = target
            if depth > bottom + 1e-9:
                yield f"g0z{number(min(depth + self.q(258, _ADVANCED_STOP_MM), self.clear))}"

    def sink_front(self) -> Iterator[str]:
        """Q358 with the tool's front, Q359 beside the middle of the hole."""
        depth, aside = self.q(358, 0.0), self.q(359, 0.0)
        if depth == 0.0:
            return
        feed = f"f{number(self.q(254, self.data.get('206')))}"
        yield f"g1{self.beside}z{number(self.surface + depth)}f{number(self.approach)}"
        if aside > 0.0:
            wall = xy_words(self.x + aside, self.y)
            lead = "g1{}" if self.is_outside else f"g3{{}}r{number(aside / 2.0)}"
            yield lead.format(wall) + feed
            yield f"g3{wall}i{number(-aside)}j0"
            yield lead.format(self.beside)

    def blocks(self) -> Iterator[str]:
        """The cycle as blocks of RS274/NGC."""
        if self.is_outside:
            yield f"g0{self.beside}"
        yield f"g0z{number(self.clear)}"
        if self.cycle == 264:
            yield from self.drill()
        elif self.cycle == 263:
            yield from self.countersink()
        sinks_last = self.cycle == 265 and self.q(360, 0.0) == 1.0
        if self.cycle != 262 and not sinks_last:
            yield from self.sink_front()
        yield from self.helices()
        if sinks_last:
            yield from self.sink_front()
        yield f"g0z{number(self.out)}"
        if self.is_outside:
            yield f"g0{xy_words(self.x, self.y)}"


def mill_thread(reader: KlartextReader, cycle: int, data: Mapping[str, float]) -> None:
    """Do a cycle at the present place; the tool ends above it."""
    reader.controller.note(
        f"CYCL DEF {cycle}",
        "the way to the wall is the control's own; the helix is that of the cycle",
    )
    reader.execute(*_Thread(reader, cycle, data).blocks())
