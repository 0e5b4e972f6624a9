"""Klartext cycles 200 to 207, 209, 240 and 241: holes as plain moves.

HEIDENHAIN TNC 640, User's Manual Cycle Programming, "Fixed cycles: drilling" and "tapping".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from gcode.dialects.heidenhain.cycles.parameter import cycle_parameter
from gcode.errors import ProgramError
from gcode.language.translate import number, xy_words

if TYPE_CHECKING:
    from gcode.dialects.heidenhain.reader import KlartextReader

__all__ = ["DRILLING", "drill"]

#: above the last depth where the tool goes back into the hole, mm
_ADVANCED_STOP_MM = 0.2
_MOST_PECKS = 10_000  #: more is a slip of the decimal point, and would take seconds a hole
#: by which cycle 202 takes the edge from the wall, mm
_OFF_THE_WALL_MM = 0.2


#: Q214 -> where the edge is taken
_SIDES = {0: (0, 0), 1: (-1, 0), 2: (0, -1), 3: (1, 0), 4: (0, 1)}
#: cycles that turn the spindle back or stop it, so that plain lines cannot take their place
_SPINDLE = {
    202: "boring with a stopped spindle",
    204: "boring with a stopped spindle",
    206: "tapping",
    207: "tapping",
    209: "tapping",
}


class _Hole:
    """One hole at the present place."""

    def __init__(self, reader: KlartextReader, cycle: int, data: Mapping[str, float]) -> None:
        self.reader, self.cycle, self.data = reader, cycle, data
        self.surface = self.q(203, 0.0)
        self.clear = self.surface + self.q(200)
        self.bottom = self.surface + (-self.q(250) if "250" in data else self.q(201))
        if self.q(395, 0.0):
            raise ProgramError(
                "Q395=1: the depth is that of the cylindrical part, and the point of the tool is "
                "not known", accepted="Q395=0, the depth of the tip"
            )  # fmt: skip
        self.out = max(self.clear, self.surface + self.q(204, 0.0))
        self.feed_in = self.q(206, self.data.get("254"))
        if self.bottom >= self.surface:
            raise ProgramError(f"cycle depth Q201={self.q(201):g}", accepted="a negative depth")

    def q(self, number: int, default: float | None = None) -> float:
        """A parameter of the cycle."""
        return cycle_parameter(self.data, self.cycle, number, default)

    def rapid(self, level: float) -> None:
        """FMAX along the tool axis."""
        self.reader.execute(f"g0z{number(level)}")

    def feed(self, level: float, feed: float | None = None) -> None:
        """At the plunging feed, or another one."""
        rate = feed or self.feed_in
        self.reader.execute(f"g1z{number(level)}f{number(rate)}")

    def dwell(self, key: int) -> None:
        """A dwell in seconds."""
        if self.q(key, 0.0) > 0.0:
            self.reader.execute(f"g4p{number(self.q(key))}")

    def pecks(self, start: float | None = None) -> list[float]:
        """Depths of all infeeds but the last: Q202, less Q212 each time, not below Q205."""
        step, less = abs(self.q(202, 0.0)), abs(self.q(212, 0.0))
        least = min(abs(self.q(205, 0.0)) or step, step) if less else step
        if step == 0.0:
            return []
        depth = self.surface if start is None else start
        depths = []
        while len(depths) <= _MOST_PECKS:
            depth -= max(step, least)
            step -= less
            if depth - self.bottom < 1e-9:
                return depths
            depths.append(depth)
            if least <= 0.0 and step <= 0.0:
                raise ProgramError(f"infeeds that shrink by Q212={less:g} to nothing",
                                   accepted="a least infeed Q205")  # fmt: skip
        raise ProgramError(f"infeeds Q202={self.q(202):g} make more than {_MOST_PECKS} steps")


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
    """Cycle 203; Q213 breaks chips before the tool comes out."""
    breaks, back, done = int(hole.q(213, 0.0)), hole.q(256, 0.2), 0
    for depth in hole.pecks():
        hole.feed(depth)
        if done < breaks:
            hole.rapid(min(depth + back, hole.clear))
            done += 1
        else:
            _come_out(hole, depth, _ADVANCED_STOP_MM)
            done = 0
    hole.feed(hole.bottom)
    hole.dwell(211)
    _leave(hole)


def _come_out(hole: _Hole, depth: float, ahead: float) -> None:
    hole.rapid(hole.clear)
    hole.dwell(210)
    hole.rapid(min(depth + ahead, hole.clear))


def _leave(hole: _Hole) -> None:
    if hole.q(208, 0.0) and hole.q(208) < 99_999.0:
        hole.feed(hole.clear, hole.q(208))


def _deep(hole: _Hole) -> None:
    """Cycle 205: Q379 is a start below the surface, Q257 the depth between two chip breaks."""
    start = hole.surface - abs(hole.q(379, 0.0))
    if start < hole.surface:
        hole.feed(start + hole.q(200), hole.q(253, hole.feed_in))
    breaks, back = abs(hole.q(257, 0.0)), hole.q(256, 0.2)
    before = start
    for depth in [*hole.pecks(start), hole.bottom]:
        while breaks > 0.0 and before - breaks > depth + 1e-9:
            before -= breaks
            hole.feed(before)
            hole.rapid(min(before + back, hole.clear))
        hole.feed(depth)
        if depth != hole.bottom:
            _come_out(hole, depth, hole.q(258, _ADVANCED_STOP_MM))
        before = depth
    hole.dwell(211)
    _leave(hole)


def _single_lip(hole: _Hole) -> None:
    """Cycle 241: to the start at Q253, to the depth, out at Q208."""
    start = hole.surface - abs(hole.q(379, 0.0))
    hole.feed(start + hole.q(200), hole.q(253, hole.feed_in))
    hole.feed(hole.bottom)
    hole.dwell(211)
    _leave(hole)


def _boring(hole: _Hole) -> None:
    """Cycle 202: Q214 takes the edge from the wall before the tool comes out."""
    hole.feed(hole.bottom)
    hole.dwell(211)
    aside = _SIDES.get(int(hole.q(214, 0.0)))
    if aside is None:
        raise ProgramError(f"Q214={hole.q(214):g}", accepted="0 to 4")
    here = hole.reader.here()
    hole.reader.execute(_beside(here, aside))
    hole.rapid(hole.clear)
    hole.reader.execute(_beside(here, (0, 0)))


def _back_boring(hole: _Hole) -> None:
    """Cycle 204: through the hole with the edge aside, then a counterbore from below."""
    edge, under = hole.q(252), hole.surface - hole.q(250)
    aside = _SIDES.get(int(hole.q(214)))
    if aside is None or not any(aside):
        raise ProgramError(f"Q214={hole.q(214):g}", accepted="1 to 4")
    here, away = hole.reader.here(), hole.q(251)
    below = under - hole.q(200) - edge
    hole.reader.execute(_beside(here, aside, away))
    hole.feed(below, hole.q(253))
    hole.reader.execute(_beside(here, (0, 0)))
    hole.feed(under + hole.q(249) - edge, hole.q(254))
    hole.dwell(255)
    hole.rapid(below)
    hole.reader.execute(_beside(here, aside, away))
    hole.rapid(hole.clear)
    hole.reader.execute(_beside(here, (0, 0)))


def _beside(here: list[float], aside: tuple[int, int], away: float = _OFF_THE_WALL_MM) -> str:
    place = [h + away * a for h, a in zip(here, aside, strict=False)]
    return f"g0{xy_words(place[0], place[1])}"


def _tapping_in_steps(hole: _Hole) -> None:
    """Cycle 209: Q257 to a chip break, back by Q256 turns of the pitch, or out with Q256 = 0."""
    breaks, back = abs(hole.q(257, 0.0)), hole.q(256, 0.0) * abs(hole.q(239))
    depth = hole.surface
    while breaks > 0.0 and depth - breaks > hole.bottom + 1e-9:
        depth -= breaks
        hole.feed(depth)
        hole.feed(min(depth + back, hole.clear) if back else hole.clear)
    hole.feed(hole.bottom)
    hole.feed(hole.clear)


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
    """Cycles 207 and 209 have a pitch in place of a feed."""
    if "239" not in data:
        raise ProgramError("Q239 (pitch) of the cycle is missing")
    tenths = 1.0 if reader.controller.unit_mm == 1.0 else 10.0  # F counts 0.1 inch/min
    return data | {"206": abs(data["239"]) * reader.controller.speed * tenths}


DRILLING: dict[int, Callable[[_Hole], None]] = {
    200: _drilling, 201: _reaming, 202: _boring, 203: _universal, 204: _back_boring, 205: _deep,
    206: _tapping, 207: _tapping, 209: _tapping_in_steps, 240: _centring, 241: _single_lip,
}  # fmt: skip


def drill(reader: KlartextReader, number: int, data: dict[str, float]) -> None:
    """Do a cycle at the present place."""
    if number in (207, 209):
        data = _rigid(reader, data)
    if number in _SPINDLE:
        reader.keep(_SPINDLE[number])
    hole = _Hole(reader, number, data)
    hole.rapid(hole.clear)
    DRILLING[number](hole)
    hole.rapid(hole.out)
