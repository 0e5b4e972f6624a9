"""Klartext cycles 200, 201, 203, 206, 207 and 240: holes as plain moves.

HEIDENHAIN TNC 640, User's Manual Cycle Programming, "Fixed cycles: drilling" and "tapping".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from gcode.errors import ProgramError

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["DRILLING", "drill"]

#: above the last depth where the tool goes back into the hole, mm
_ADVANCED_STOP_MM = 0.2
_MOST_PECKS = 100_000


class _Hole:
    """One hole at the present place."""

    def __init__(self, reader: KlartextReader, data: Mapping[str, float]) -> None:
        self.reader, self.data = reader, data
        self.surface = self.q(203, 0.0)
        self.clear = self.surface + self.q(200)
        self.bottom = self.surface + self.q(201)
        self.out = max(self.clear, self.surface + self.q(204, 0.0))
        self.feed_in = self.q(206)
        if self.q(201) >= 0.0:
            raise ProgramError(f"cycle depth Q201={self.q(201):g}", accepted="a negative depth")

    def q(self, number: int, default: float | None = None) -> float:
        """A parameter of the cycle."""
        value = self.data.get(str(number), default)
        if value is None:
            raise ProgramError(f"Q{number} of the cycle is missing")
        return value

    def rapid(self, level: float) -> None:
        """FMAX along the tool axis."""
        self.reader.execute(f"g0z{level!r}")

    def feed(self, level: float, feed: float | None = None) -> None:
        """At the plunging feed, or another one."""
        rate = feed or self.feed_in
        self.reader.execute(f"g1z{level!r}f{rate!r}")

    def dwell(self, number: int) -> None:
        """A dwell in seconds."""
        if self.q(number, 0.0) > 0.0:
            self.reader.execute(f"g4p{self.q(number)!r}")

    def pecks(self) -> list[float]:
        """Depths of all infeeds but the last."""
        step = abs(self.q(202, 0.0))
        if step == 0.0:
            return []
        count = (self.surface - self.bottom) / step
        if count > _MOST_PECKS:
            raise ProgramError(f"infeeds Q202={step:g} make {count:.0f} steps")
        depths = [self.surface - step * k for k in range(1, int(count) + 1)]
        return [depth for depth in depths if depth - self.bottom > 1e-9]


def _drilling(hole: _Hole) -> None:
    for depth in hole.pecks():
        hole.feed(depth)
        hole.rapid(hole.clear)
        hole.dwell(210)
        hole.rapid(min(depth + _ADVANCED_STOP_MM, hole.clear))
    hole.feed(hole.bottom)
    hole.dwell(211)


def _reaming(hole: _Hole) -> None:
    hole.feed(hole.bottom)
    hole.dwell(211)
    hole.feed(hole.clear, hole.q(208, 0.0))


def _universal(hole: _Hole) -> None:
    """Cycle 203 without decrement; Q213 breaks chips before the tool comes out."""
    if hole.q(212, 0.0):
        raise ProgramError("cycle 203 with a decrement Q212 is not read", accepted="Q212=0")
    breaks, back, done = int(hole.q(213, 0.0)), hole.q(256, 0.2), 0
    for depth in hole.pecks():
        hole.feed(depth)
        if done < breaks:
            hole.rapid(min(depth + back, hole.clear))
            done += 1
        else:
            hole.rapid(hole.clear)
            hole.dwell(210)
            hole.rapid(min(depth + _ADVANCED_STOP_MM, hole.clear))
            done = 0
    hole.feed(hole.bottom)
    hole.dwell(211)
    if hole.q(208, 0.0) and hole.q(208) < 99_999.0:
        hole.feed(hole.clear, hole.q(208))


def _tapping(hole: _Hole) -> None:
    hole.feed(hole.bottom)
    hole.dwell(211)
    hole.feed(hole.clear)


def _centring(hole: _Hole) -> None:
    if hole.q(343, 0.0):
        raise ProgramError("cycle 240 by diameter (Q343=1) is not read", accepted="Q343=0")
    hole.feed(hole.bottom)
    hole.dwell(211)


def _rigid(reader: KlartextReader, data: dict[str, float]) -> dict[str, float]:
    """Cycle 207 has a pitch in place of a feed."""
    if "239" not in data:
        raise ProgramError("Q239 (pitch) of the cycle is missing")
    return data | {"206": abs(data["239"]) * reader.controller.speed}


DRILLING: dict[int, Callable[[_Hole], None]] = {
    200: _drilling, 201: _reaming, 203: _universal, 206: _tapping, 207: _tapping, 240: _centring,
}  # fmt: skip


def drill(reader: KlartextReader, number: int, data: dict[str, float]) -> None:
    """Do a cycle at the present place."""
    if number == 207:
        data = _rigid(reader, data)
    hole = _Hole(reader, data)
    hole.rapid(hole.clear)
    DRILLING[number](hole)
    hole.rapid(hole.out)
