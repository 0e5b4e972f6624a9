"""Pockets, slots and studs of the controls' milling cycles as blocks of RS274/NGC.

What a cycle leaves is in the manuals: walls, floor, allowances. Its way through the material is the
control's own; here rings are milled from the inside out (studs: from the outside in).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from gcode.errors import ProgramError
from gcode.geometry.curved_slot import CurvedSlot
from gcode.geometry.outlines import Outline
from gcode.geometry.polygons import Polygon
from gcode.language.translate import number

__all__ = ["Area", "check_rounds", "mill_bore", "mill_pocket", "mill_stud"]

#: more rings or levels than this are a mistake
_MOST = 10_000
#: rings on all levels together: more would take seconds, and are a slip of the decimal point
_MOST_ROUNDS = 20_000


@dataclass(frozen=True)
class Area:
    """What a milling cycle is told, program units; levels are absolute.

    Attributes
    ----------
    outline : Outline, CurvedSlot or Polygon
        The finished wall.
    tool_radius : float
    surface, bottom, clear : float
        Levels of the material, the floor, and above it where rapids are allowed.
    step_down, step_over : float
        Infeeds along the tool axis and across.
    feed, plunge_feed, finish_feed : float
    side_allowance, floor_allowance : float
        Left by roughing.
    rough, finish : bool
        Which of the two is done.
    clockwise : bool
        Sense in which walls are gone round.
    blank : Outline or None
        Of a stud: what stands before.
    """

    outline: Outline | CurvedSlot | Polygon
    tool_radius: float
    surface: float
    bottom: float
    clear: float
    step_down: float
    step_over: float
    feed: float
    plunge_feed: float
    finish_feed: float
    side_allowance: float = 0.0
    floor_allowance: float = 0.0
    rough: bool = True
    finish: bool = True
    clockwise: bool = False
    blank: Outline | None = None

    def __post_init__(self) -> None:
        if not self.tool_radius > 0.0:
            raise ProgramError("a milling cycle needs a tool with a diameter")
        if not self.bottom < self.surface:
            raise ProgramError(f"depth {self.bottom:g} is not below the surface {self.surface:g}")
        if not 0.0 < self.step_over <= 2.0 * self.tool_radius:
            raise ProgramError(
                f"infeed across of {self.step_over:g}",
                accepted="above 0, up to the tool's diameter",
            )

    def levels(self, floor: float) -> list[float]:
        """Levels of the infeeds down to a floor."""
        depth = self.surface - floor
        count = math.ceil(depth / self.step_down - 1e-9) if self.step_down > 0.0 else 1
        if count > _MOST:
            raise ProgramError(f"infeeds of {self.step_down:g} make {count} levels")
        return [self.surface - depth * (k + 1) / count for k in range(count)]

    @property
    def passes(self) -> Iterator[tuple[list[float], float, float]]:
        """Levels, allowance and feed of roughing and finishing, where they are done."""
        leaves = self.side_allowance > 0.0 or self.floor_allowance > 0.0
        if self.rough:
            yield (self.levels(self.bottom + self.floor_allowance), self.side_allowance, self.feed)
        if self.finish and (leaves or not self.rough):
            yield [self.bottom], 0.0, self.finish_feed


def _line(kind: str, point: tuple[float, float], feed: float | None = None) -> str:
    text = f"{kind}x{number(point[0])}y{number(point[1])}"
    return text if feed is None else f"{text}f{number(feed)}"


def _level(kind: str, level: float, feed: float | None = None) -> str:
    return f"{kind}z{number(level)}" + ("" if feed is None else f"f{number(feed)}")


def _round(ring: Outline | CurvedSlot | Polygon, feed: float, *, clockwise: bool) -> Iterator[str]:
    """To a ring's start, and round it."""
    here = ring.start
    yield _line("g1", here, feed)
    for element in ring.round(clockwise=clockwise):
        turns = "g2" if clockwise != element.against else "g3"
        text = _line("g1" if element.centre is None else turns, element.end)
        if element.centre is not None:
            text += f"i{number(element.centre[0] - here[0])}j{number(element.centre[1] - here[1])}"
        yield text
        here = element.end


def _rings(area: Area, allowance: float) -> list[Outline]:
    """Ways of the tool's axis in a pocket, the innermost first."""
    distance = area.tool_radius + allowance
    ring = area.outline.grown(-distance)
    if ring is None:
        raise ProgramError(
            f"a tool of radius {area.tool_radius:g} is too large for "
            f"{2.0 * min(area.outline.half_length, area.outline.half_width):g}"
        )
    rings = [ring]
    while len(rings) < _MOST:
        distance += area.step_over
        ring = area.outline.grown(-distance)
        if ring is None:
            break
        rings.append(ring)
    return rings[::-1]


def check_rounds(rings: int, levels: int) -> None:
    """Refuse what would take the control days, and the reader minutes."""
    if rings * levels > _MOST_ROUNDS:
        raise ProgramError(f"{rings} rings or lines on {levels} levels",
                           accepted=f"up to {_MOST_ROUNDS} together",
                           hint="look at the infeeds and at the tool's diameter")  # fmt: skip


def mill_pocket(area: Area) -> Iterator[str]:
    """Blocks of a pocket or slot; the tool is taken straight down in the middle."""
    for levels, allowance, feed in area.passes:
        rings = _rings(area, allowance)
        check_rounds(len(rings), len(levels))
        yield _line("g0", rings[0].start)
        yield _level("g0", area.clear)
        for level in levels:
            yield _level("g1", level, area.plunge_feed)
            for ring in rings:
                if not ring.is_point:
                    yield from _round(ring, feed, clockwise=area.clockwise)
            yield _line("g1", rings[0].start, feed)
        yield _level("g0", area.clear)


def mill_stud(area: Area) -> Iterator[str]:
    """Blocks round a stud, from its blank inwards."""
    blank = area.blank or area.outline
    excess = max(
        blank.half_length - area.outline.half_length,
        blank.half_width - area.outline.half_width,
        0.0,
    )
    for levels, allowance, feed in area.passes:
        nearest = area.tool_radius + allowance
        count = max(math.ceil((excess - allowance) / area.step_over - 1e-9), 1)
        distances = [nearest + area.step_over * k for k in range(min(count, _MOST))][::-1]
        check_rounds(len(distances), len(levels))
        outside = area.outline.grown(area.tool_radius + excess + area.step_over)
        yield _line("g0", outside.start)
        yield _level("g0", area.clear)
        for level in levels:
            yield _level("g1", level, area.plunge_feed)
            for distance in distances:
                ring = area.outline.grown(distance)
                yield from _round(ring, feed, clockwise=area.clockwise)
            yield _line("g1", outside.start, feed)
        yield _level("g0", area.clear)


def mill_bore(area: Area, pitch: float) -> Iterator[str]:
    """A helix down a round hole, a whole turn on its floor, and out in the middle."""
    ring = area.outline.grown(-area.tool_radius)
    if ring is None or ring.is_point:
        raise ProgramError(
            f"a tool of radius {area.tool_radius:g} does not mill a bore of "
            f"{2.0 * area.outline.half_length:g}"
        )
    if not pitch > 0.0 or (area.clear - area.bottom) / pitch > _MOST:
        raise ProgramError(f"helix with an infeed of {pitch:g} a turn")
    centre, radius, code = ring.centre, ring.half_length, "g2" if area.clockwise else "g3"
    start = centre[0] + radius, centre[1]
    yield _line("g0", centre)
    yield _level("g0", area.clear)
    yield _line("g1", start, area.feed)
    turns = max(math.ceil((area.clear - area.bottom) / pitch - 1e-9), 1)
    for turn in range(1, turns + 1):
        level = area.clear - (area.clear - area.bottom) * turn / turns
        yield _line(code, start) + f"z{number(level)}i{number(-radius)}j0"
    yield _line(code, start) + f"i{number(-radius)}j0"
    yield _line("g1", centre)
    yield _level("g0", area.clear)
