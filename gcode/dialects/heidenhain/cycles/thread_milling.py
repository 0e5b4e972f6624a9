"""Klartext cycles 262 to 264: internal threads by a mill on a helix.

Source: HEIDENHAIN TNC 426/430 User's Manual, "Cycles for drilling, tapping and thread milling":
262 mills a thread into a hole, 263 countersinks it first, 264 drills it first. A right-hand thread
is milled upwards by climb milling and downwards by up-cut milling, a left-hand one the other way.
How the tool comes to the wall is the control's own; a semicircle is taken here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.tool_call import tool_of_spindle
from gcode.errors import ProgramError
from gcode.language.translate import number

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["THREADS", "mill_thread"]

THREADS = frozenset((262, 263, 264))
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
        self.radius = self.q(335) / 2.0 - self.tool_radius
        self.approach = self.q(253)
        if self.q(201) >= 0.0 or self.pitch == 0.0:
            raise ProgramError(f"thread with Q201={self.q(201):g} and Q239={self.pitch:g}",
                               accepted="a negative depth and a pitch")  # fmt: skip
        if self.radius <= 0.0:
            raise ProgramError(f"a tool of radius {self.tool_radius:g} does not mill a thread of "
                               f"{self.q(335):g}")  # fmt: skip

    def q(self, name: int, default: float | None = None) -> float:
        """A parameter."""
        value = self.data.get(str(name), default)
        if value is None:
            raise ProgramError(f"Q{name} of cycle {self.cycle} is missing")
        return value

    # thread

    def turns(self) -> list[tuple[float, float]]:
        """Where helices begin and end along Z, each with an approach of its own."""
        step, lead = int(self.q(355, 1.0 if self.cycle != 262 else 0.0)), abs(self.pitch)
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
        return (self.pitch > 0.0) == self.climbs

    def helices(self) -> Iterator[str]:
        """Blocks of the thread, from the middle of the hole and back to it."""
        code, feed = "g3" if self.climbs else "g2", f"f{number(self.q(207))}"
        wall = self.x + self.radius
        middle = f"x{number(self.x)}y{number(self.y)}"
        for first, last in self.turns():
            count = round(abs(last - first) / abs(self.pitch))
            if count > _MOST_TURNS:
                raise ProgramError(f"thread of {count} turns")
            yield f"g1{middle}z{number(first)}f{number(self.approach)}"
            yield f"{code}x{number(wall)}y{number(self.y)}r{number(self.radius / 2.0)}{feed}"
            yield (f"{code}x{number(wall)}y{number(self.y)}z{number(last)}"
                   f"i{number(-self.radius)}j0p{count}")  # fmt: skip
            yield f"{code}{middle}r{number(self.radius / 2.0)}"

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
        middle = f"x{number(self.x)}y{number(self.y)}"
        yield f"g1{middle}z{number(self.surface + depth)}f{number(self.approach)}"
        if aside > 0.0:
            wall = f"x{number(self.x + aside)}y{number(self.y)}"
            yield f"g3{wall}r{number(aside / 2.0)}{feed}"
            yield f"g3{wall}i{number(-aside)}j0"
            yield f"g3{middle}r{number(aside / 2.0)}"

    def blocks(self) -> Iterator[str]:
        """The cycle as blocks of RS274/NGC."""
        yield f"g0z{number(self.clear)}"
        if self.cycle == 264:
            yield from self.drill()
        elif self.cycle == 263:
            yield from self.countersink()
        if self.cycle != 262:
            yield from self.sink_front()
        yield from self.helices()
        yield f"g0z{number(self.out)}"


def mill_thread(reader: KlartextReader, cycle: int, data: Mapping[str, float]) -> None:
    """Do a cycle at the present place; the tool ends above it."""
    reader.controller.note(
        f"CYCL DEF {cycle}",
        "the way to the wall is the control's own; the helix is that of the cycle",
    )
    reader.execute(*_Thread(reader, cycle, data).blocks())
